/* SPDX-License-Identifier: MIT */
#include "cli/place.h"

#include <string.h>

#include "cli/command.h"

bool place_is_name(const char *text, size_t length)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    if (length == 0 || length >= PLACE_NAME || strchr("-_.", text[0]) != NULL) return false;
    return strspn(text, letters) >= length;
}

static bool take_name(sensor_place_t *place, const char *command, const char *word, size_t length)
{
    if (place_is_name(word, length)) {
        memcpy(place->name, word, length);
        return true;
    }
    (void)usage_error(
        command,
        "%s: a name has up to %d letters, digits, - _ and ., the first a letter or digit, such as "
        "tank-1=a16; not '%.*s'",
        word, PLACE_NAME - 1, (int)length, word);
    return false;
}

static bool take_port(sensor_place_t *place, const char *command, char *word, char *port)
{
    const size_t length = strcspn(port, ",");
    if (length == 0) {
        (void)usage_error(command, "%s: the port is missing behind @, such as @/dev/ttyUSB0", word);
        return false;
    }
    if (port[length] == ',' &&
        !port_keys_parse(&place->keys, command, word, port_kind(port, length), port + length + 1))
        return false;
    port[length] = '\0';
    place->port = port;
    return true;
}

bool place_parse(sensor_place_t *place, const char *command, char *word)
{
    char *const at = strchr(word, '@');
    const size_t length = at != NULL ? (size_t)(at - word) : strlen(word);
    const char *const equals = memchr(word, '=', length);
    const char *const sensor = equals != NULL ? equals + 1 : word;
    memset(place, 0, sizeof *place);
    place->word = word;
    if (equals != NULL && !take_name(place, command, word, (size_t)(equals - word))) return false;
    return sensor_text_parse(&place->sensor, command, sensor, length - (size_t)(sensor - word)) &&
           (at == NULL || take_port(place, command, word, at + 1));
}

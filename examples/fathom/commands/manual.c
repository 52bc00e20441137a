/* SPDX-License-Identifier: MIT */
#include "commands/commands.h"

/* The topics that explain a task from its beginning to its end. Lines have 80 columns at most. */

void topic_log(FILE *to)
{
    (void)fputs("A log that goes on for years:\n\n"
                "  fathom read a16:1 --port /dev/ttyUSB0 --reconnect --quiet --format csv\n"
                "      --output tank.csv --rotate day\n\n"
                "--rotate day appends each row to the file of its day in UTC, such as\n"
                "tank-2026-11-23.csv, and starts a new file with the header line. No file is\n"
                "renamed or copied, so no row is lost or cut off, and logrotate is not needed. To\n"
                "delete files that are older than 90 days:\n\n"
                "  find . -name 'tank-*.csv' -mtime +90 -delete\n\n"
                "Each row is written at once by one system call. If the reader of a pipe or of a\n"
                "terminal stops (Ctrl-S), all sensors and --duration wait for it; a signal ends\n"
                "the command. With '>> log.csv', use --no-header if the file has a header line. A\n"
                "file whose header has other columns is refused: exit status 1.\n\n"
                "--quiet suppresses all messages but those that end the command, and --stats.\n\n"
                "With --reconnect, a port that is lost or missing is tried again after 0.5 s,\n"
                "then after twice the time, up to 8 s. The loss is one failed attempt of each of\n"
                "its sensors. Without it, the loss ends the reading of these sensors; the\n"
                "command ends when no sensor is left.\n",
                to);
}

void topic_publish(FILE *to)
{
    (void)fputs("'fathom publish FILE' reads all sensors of a site and sends their readings to an\n"
                "MQTT broker (3.1.1, QoS 1). 'fathom publish --check FILE' checks the file and\n"
                "prints the topics. 'fathom help config' has the keys of the file. These topics\n"
                "begin with PREFIX/SITE, by default fathom/HOSTNAME:\n\n"
                "  status             online; offline when the program has ended (retained)\n"
                "  publisher          utc, version, boot, uptime_s, sensors, queued, dropped:\n"
                "                     after each connect, and when messages were dropped\n"
                "                     (retained)\n"
                "  NAME/availability  online; offline if the port is lost, if an automatic output\n"
                "                     has stopped, or after three failed attempts in a row\n"
                "                     (retained)\n"
                "  NAME/counters      every minute: attempts, failures by status, and the\n"
                "                     counters of the line (retained)\n"
                "  NAME/state         each reading and each failed attempt\n"
                "  NAME/level         the same, if the sensor has level:\n"
                "  NAME/alarm         each change, if the sensor has alarm: (retained)\n\n"
                "An a05 that reports several probes has NAME/PROBE/state, level and alarm. The\n"
                "messages of the last three topics are JSON objects. A member is null if its\n"
                "value is not known:\n\n"
                "  member             in             meaning\n"
                "  utc                all            Date and time of the measurement\n"
                "  status             state, level   as in 'fathom help output'\n"
                "  distance_mm        state, alarm   with median: the median\n"
                "  temperature_degc   state          with temperature:\n"
                "  level_mm           level          level in the tank\n"
                "  level_per_mille    level          level as a part of the height\n"
                "  volume             level          in the unit of the capacity\n"
                "  alarm              alarm          on, off, unknown or no_response\n"
                "  is_on              alarm          true or false\n"
                "  boot               all            16 hexadecimal digits, new at each start\n"
                "  seq                all            1, 2, 3 ... of this topic since the start\n"
                "  age_ms             all            time from the measurement to the broker\n"
                "  dropped            all            messages of this topic that were dropped\n"
                "                                    since the start, before this one\n",
                to);
}

void topic_delivery(FILE *to)
{
    (void)fputs("What 'fathom publish' loses, and what it does not lose:\n\n"
                "While the broker does not respond, messages wait in memory in their order, up to\n"
                "the limits of queue:. If there are more, the oldest is dropped and counted in\n"
                "'dropped'. Within one 'boot', a gap in the 'seq' of a topic is as large as the\n"
                "increase of 'dropped'.\n\n"
                "Up to 16 messages wait for the broker's acknowledgement. After a lost connection\n"
                "they are sent again, in their order and before any other. A message can arrive\n"
                "twice. No message arrives for the first time after a later one.\n\n"
                "The command connects again after at most 0.5 s, then after twice the time, up to\n"
                "a minute. The sensors are read meanwhile. After a signal, the command sends what\n"
                "is left for at most 2 s. A kill or a power failure loses what waits in memory.\n"
                "Whether the broker keeps an acknowledged message for a subscriber that is not\n"
                "connected is set in the broker (persistence) and in the subscriber (QoS 1, its\n"
                "own client id, no clean session).\n\n"
                "SIGHUP reads the file again. A line that has not changed is read without a gap.\n"
                "A line that has changed is closed when no request is pending, and opened again:\n"
                "its sensors miss one interval. Retained messages of sensors that are no longer\n"
                "in the file are deleted. A file with an error changes nothing.\n",
                to);
}

void topic_boxes(FILE *to)
{
    (void)fputs("Several computers, Home Assistant, and security with 'fathom publish':\n\n"
                "Each computer needs its own site:, by default the name of the host. The site is\n"
                "part of all topics, of the client id (fathom-mill-north) and of the ids in Home\n"
                "Assistant. Two programs with the same client id end each other's connection\n"
                "again and again. A site can have levels: mill/north, mill/south. Then all\n"
                "computers can use one broker, or bridged brokers:\n\n"
                "  topic fathom/mill/north/# out 1        # in mosquitto.conf\n\n"
                "One subscription receives all states: fathom/+/+/+/state or fathom/#.\n\n"
                "Home Assistant finds the sensors if its MQTT integration uses the same broker\n"
                "and the prefix homeassistant, or the one of discovery:. Each sensor is a\n"
                "device. Its entities are distance, temperature, level, filled (in percent) and\n"
                "alarm (a binary sensor of class problem). An entity is unavailable while the\n"
                "computer or the sensor is. Its value is unknown if none has arrived for three\n"
                "intervals and 30 s. discovery: off sends nothing to Home Assistant.\n\n"
                "'fathom publish' never writes to a sensor, and subscribes to nothing. Passwords\n"
                "stand in a file of their own (password-file) or are credentials of systemd\n"
                "(password-credential), and are read again for each connection. With tls:, the\n"
                "certificate of the broker must be signed by an authority in ca-file and be\n"
                "valid for host. TLS 1.2 is the oldest version that is accepted.\n",
                to);
}

void topic_commission(FILE *to)
{
    (void)fputs("New sensors all have address 1, and each HPS-167S has its termination resistor\n"
                "switched on, so they cannot share a line. 'fathom commission' gives them\n"
                "addresses one after the other:\n\n"
                "  fathom commission hps167s --port /dev/ttyUSB0 --addresses 2-4\n"
                "      --record hall.txt\n\n"
                "The command prints which address the next sensor gets. Connect the sensors one\n"
                "after the other. Before it writes, the command checks that no sensor responds at\n"
                "the new address and that the sensor at address 1 is alone (an HPS-167S by its\n"
                "UUID, read three times). Then it writes the termination (off in all but the\n"
                "last) and the address, each once, and only if the sensor has another value. At\n"
                "the new address it reads the UUID, the termination and a measurement. If two\n"
                "sensors have address 1, none is written.\n\n"
                "The record is a text file with a line for each sensor. It is on the disk before\n"
                "anything is written. After Ctrl-C, a write that was not confirmed, or a power\n"
                "failure, run the same command again: it looks for each sensor of the record and\n"
                "continues. States in the record:\n\n"
                "  planned   The sensor is at its address, or still at address 1. If it responds\n"
                "            at neither, its address stays reserved. If it reports its new\n"
                "            termination only after a power cycle, switch it off and on, and run\n"
                "            the command again.\n"
                "  done      The sensor is verified. Its address is not assigned again.\n\n"
                "An HPS-167S is known by its UUID and can be taken off the line afterwards. An\n"
                "A16 or A05 has no UUID: keep the finished ones connected and switched on. If\n"
                "you took one away, remove its line from the record and its address from\n"
                "--addresses. Two A16 or A05 that send the same bytes at the same moment look\n"
                "like one sensor: connect one at a time.\n",
                to);
}

void topic_calibrate(FILE *to)
{
    (void)fputs("An HPS-167S keeps its distance offset (command #12) in flash and does not report\n"
                "it. The datasheet does not state whether a new offset replaces the old one or is\n"
                "added to it. 'fathom calibrate' measures a target at a known distance, writes,\n"
                "and measures again:\n\n"
                "  fathom calibrate hps167s:7 --port /dev/ttyUSB0 --known 2000\n\n"
                "  1. The command compares the median of 25 samples with the known distance. If\n"
                "     they agree within half the spread of the samples, and at least 2 mm,\n"
                "     nothing is written.\n"
                "  2. Otherwise the difference is written as the offset. Usually the sensor is\n"
                "     right then.\n"
                "  3. If the distance shows that the write replaced an old offset, the offset\n"
                "     that does not depend on the old one is written.\n\n"
                "Flash is written at most twice, and each write is announced. No write is\n"
                "repeated: if an acknowledgement is lost, the distance shows whether the sensor\n"
                "accepted the offset. If it does not show that (the distance has not changed, the\n"
                "samples differ too much, the target is gone, Ctrl-C), the command stops and\n"
                "prints which offsets the sensor may have and what to do. If another program has\n"
                "written an offset since the last power-on, switch the power off and on first: an\n"
                "offset may take effect only then.\n",
                to);
}

void topic_backup(FILE *to)
{
    (void)fputs("'fathom save' writes the settings of a sensor to standard output or into a new\n"
                "file. It never overwrites a file. 'fathom restore' reads the sensor, prints the\n"
                "differences, and writes only these, each setting once:\n\n"
                "  fathom save hps167s:7 --port /dev/ttyUSB0 --file gate.txt\n"
                "  fathom restore hps167s:7 --port /dev/ttyUSB0 --file gate.txt --dry-run\n\n"
                "A value can be changed in the file. A line can be removed; restore does not\n"
                "change this setting then. The values are those of 'fathom get' and 'fathom set',\n"
                "or one of these words:\n\n"
                "  not readable   The setting can be set and not read: distance-offset,\n"
                "                 filter-sensitivity and load-settings of an HPS-167S. Restore\n"
                "                 writes it only if you enter a value, and then each time. A\n"
                "                 distance-offset may be added to the present one; restore says\n"
                "                 so before it writes.\n"
                "  not there      This variant does not have the setting.\n"
                "  not settable   The sensor has a value that cannot be set. It stands behind #.\n\n"
                "With --dry-run, restore ends after the differences, with exit status 1 if there\n"
                "are any. A line with an error is reported with its number, and nothing is sent.\n\n"
                "With --as-new, the sensor takes the place of the saved one and gets its address\n"
                "and rate too. No sensor may respond at the new place. The address and then the\n"
                "rate are written last, and the identity of the sensor is read there again.\n\n"
                "Restore ends at the first write that fails or is not confirmed, and prints what\n"
                "is written and what is not. Run it again to write what still differs.\n",
                to);
}

void topic_request(FILE *to)
{
    (void)fputs("'fathom request UNIT FUNCTION ...' sends one Modbus request once and prints the\n"
                "response: its bytes, its registers as numbers and as text, and with --sensor\n"
                "their meaning. Numbers are decimal, or hexadecimal behind 0x. A register is the\n"
                "address on the wire, as the datasheets print it.\n\n"
                "  1 3 0x0106 4            Reads four registers by function 3 (or 4)\n"
                "  1 6 0x0206 2000         Writes one register; the value may be negative\n"
                "  1 16 0x0020 0 180       Writes several registers\n"
                "  1 0x2b 0e 01 00         Sends another function, 1 to 127, with these bytes\n\n"
                "Before the request is sent, the command prints what the request may do: stop an\n"
                "automatic output, write to flash, reset, reach all units. A request that can\n"
                "change something needs --yes: a write, a function other than 1 to 4, unit 0 or\n"
                "255, and a read of 0x0009, which resets an HPS-167S (commands #3 and #5 read\n"
                "over 0x0009 and are allowed). On a terminal the command asks instead.\n\n"
                "Without --sensor the line has 9600 8N1. Unit 0 means all units: none responds,\n"
                "and the command ends after 200 ms.\n\n"
                "The acknowledgement of functions 5 and 6 equals the request, and so does the\n"
                "echo of an adapter. With '--echo auto', one copy is identified by its time. If\n"
                "the time does not decide, the status is answered_or_echo, and a message says\n"
                "so.\n",
                to);
}

void topic_service(FILE *to)
{
    (void)fputs("fathom-publish.service runs 'fathom publish /etc/fathom/publish.yaml'. After the\n"
                "installation it is neither enabled nor started:\n\n"
                "  install -d -m 700 /etc/credstore\n"
                "  install -m 600 /dev/stdin /etc/credstore/fathom-mqtt-password\n"
                "      (enter the broker's password, then Ctrl-D)\n"
                "  systemctl enable --now fathom-publish\n"
                "  systemctl reload fathom-publish        reads the file again\n"
                "  journalctl -u fathom-publish           its messages\n\n"
                "The service runs as a user that exists only while it runs (DynamicUser), in the\n"
                "group dialout. The file must be readable by all. The password is a credential\n"
                "that no other user can read: write 'password-credential: fathom-mqtt-password'\n"
                "in the file. Without this key the credential may be missing.\n\n"
                "The service can use serial ports (ttyUSB, ttyACM, ttyS, ttyAMA) and GPIO chips.\n"
                "If these belong to another group, add 'SupplementaryGroups=gpio' with\n"
                "'systemctl edit fathom-publish'. It cannot write to files, and sees neither\n"
                "homes nor other processes. Wrong usage (exit status 2) is not repeated; after\n"
                "any other end the service starts again in 5 s. 'systemd-analyze security' rates\n"
                "it 1.3 of 10; what is left are the network, the serial ports and their group.\n",
                to);
}

# SPDX-License-Identifier: MIT
"""The first inputs of each target, made of the frames of the datasheets as tests/unit has them."""
import glob
import os
import re

import build

SCRIPTS = {}


def makes(*names):
    def keep(function):
        for name in names:
            SCRIPTS[name] = function
        return function
    return keep


def frames_of(text):
    """{kind: [bytes]}"""
    frames = {}
    for kind, digits in re.findall(r'^(\w+) ([0-9A-F ]+)$', text, re.M):
        frames.setdefault(kind, []).append(bytes.fromhex(digits))
    return frames


def of(name, text):
    """The seeds of a target."""
    frames = frames_of(text)
    return SCRIPTS[name](frames) if name in SCRIPTS else [b'\0' * 32]


@makes('dyp')
def dyp(frames):
    """Three frames in a row, each after a silence and fed whole."""
    found = []
    for frame in frames['stream']:
        four = 4 if len(frame) == 10 else 0
        fed = bytes([(len(frame) - 1) << 4 | 8]) + frame
        found += [bytes([2 | four, 0, 0]) + (b'\x05\xff' + fed + b'\2') * 3]
        found += [bytes([2 | four, 0, 0]) + b'\x05\xff' + fed + fed + fed + b'\2\2']
    return found


@makes('line')
def line(frames):
    """Requests of each kind with their responses, in time, late, with an echo; a cancel and a break."""
    found = []
    for kind in range(5):
        for respond in (b'\x01', b'\x12', b'\x22\x02', b'\x42\x05\1', b'\x52\x05\1'):
            begin = bytes([0x70, len(found) % 8 * 2, 0, 0])
            ask = bytes([0x0c, kind | 16, 3]) + b'\x0f\x0f'
            found.append(begin + ask + respond + b'\1\2' + b'\x0f' * 2 + ask + b'\x0f' * 2 + respond)
    return found + [b'\x30\0\0\0' + b'\x0c\x10\2\x0f\x0f\x0e\0\x0e\7\x0f\x0e\3', b'\0' * 8]


@makes('drivers')
def drivers(frames):
    """Each world: requests with their responses, frames that come by themselves, and each command twice."""
    found = []
    for world in range(11):
        begin = bytes([world, 0x0f, 0, 0]) + b'\x0f\x0f\x0f'
        values = b'\x01\x02\x03\x04\x05\x06\x07\x08' * 2
        found.append(begin + (b'\x01' + values + b'\x0f') * 2)
        unasked = [b'\x08\x05' + bytes([4 | kind << 4]) + values[:11] + b'\x0f' for kind in (0, 1, 2)]
        found.append(begin + b''.join(unasked))
        for command in range(15 if world < 2 else 12 if world < 4 else 3 if world < 6 else 2 if world > 8 else 0):
            found.append(begin + bytes([12, command, 5]) + (b'\x0f\x0f\x01' + values[:6]) * 4)
    return found


def mbap(transaction, frame):
    return transaction.to_bytes(2, 'big') + bytes([0, 0, 0, len(frame) - 2]) + frame[:-2]


@makes('tcp')
def tcp(frames):
    """The datasheets' responses to the first request, F001, whole and in two pieces; what a request asks for."""
    found = [b'\1\7' + b'\1' + b'\1\2\3\4\5\6\7\x08' * 2 + b'\7', b'\1\7\7\x32\1\2\3']
    for frame in frames['response']:
        adu = mbap(0xF001, frame)
        found.append(b'\0\7\1\3\0\x08\0\4' + bytes([(len(adu) - 1) << 3]) + adu)
        found.append(b'\0\7\1\3\0\x08\0\4' + bytes([4 << 3]) + adu[:5] + bytes([(len(adu) - 6) << 3]) + adu[5:])
    return found


@makes('libmodbus')
def libmodbus(frames):
    head = {3: 0, 6: 8, 16: 16}
    found = [bytes([head[frame[1]]]) + b'\0' + frame[2:4] + (b'\0' + bytes([frame[2] // 2 - 1]) if frame[1] == 3
             else frame[4:6]) + frame for frame in frames['response'] if frame[1] in head]
    found += [bytes([5]) + frame for frame in frames['request']]
    return found + [bytes([4]) + b'\0\0\x08\0\3' + bytes.fromhex('01 83 02 C0 F1'),
                    bytes([5]) + bytes.fromhex('01 10 00 20 00 02 04 00 00 00 12 00 00')]


@makes('decode')
def decode(frames):
    every = [frame for kind in sorted(frames) for frame in frames[kind]]
    found = [b'\0\0' + frame for frame in every] + [bytes([12, index]) + every[index] for index in range(12)]
    found += [b'\1\0' + every[0].hex(' ').encode() + b' # a comment\n0x' + every[-1].hex().encode()]
    return found + [b'\0\0' + b''.join(every[index:index + 4]) for index in range(0, len(every), 4)]


@makes('files')
def files(frames):
    """A file of each model, and records with units of each state."""
    backup = {0: 'a16', 1: 'a05', 2: 'hps167s'}
    title = b'# fathom commission: which unit has which address, or is to have it\n'
    units = [b'hps167s 2 00390025423457142034383501060705 done 2026-01-01T00:00:00Z\n',
             b'a16 3 - planned 2026-01-01T00:00:00Z\n', b'a05 254 - restart 2026-01-01T00:00:00Z\n']
    found = [bytes([index]) + f'sensor = {name}\naddress = 7\n{more}'.encode() for index, name in backup.items()
             for more in ('', 'warm-up = 5 # s\nuuid = 00390025423457142034383501060705\nbaud = 19200\n',
                          'switch-threshold = 1000\r\nswitch-polarity = positive\nautomatic-value = not there\n',
                          'filter = not readable\nreconnect-time = 36\ntermination = on\n')]
    found += [b'\4' + title + units[0] + unit for unit in (units[0], units[0].replace(b' 2 ', b' 3 '), units[1])]
    return found + [b'\4' + title + b''.join(units[:count]) for count in range(4)]


SITE = b'''site: mill/north
broker: {host: broker.lan, port: 8883, user: mill, tls: {ca-file: ca.crt}, client-id: box, keep-alive: 60}
queue: {messages: 100, bytes: 4096}
lines:
  - port: /dev/ttyUSB0
    baud: 9600
    sensors:
      - {name: tank, sensor: "a16:1:modbus", median: 5, level: {mounting: 2300, height: 2000, capacity: 5000}}
      - name: gate
        sensor: hps167s:7
        alarm: {when: near<500/600, unknown: on, no-response: on}
  - port: tcp:10.0.0.7
    sensors: [{name: bumper, sensor: "a05:2:modbus", probes: "1,2"}]
  - {port: /dev/gpiochip0, trigger: 17, echo: 27, sensors: [{name: pit, sensor: "a16::pwm"}]}
'''


@makes('site')
def site(frames):
    """One of each kind of place, and with a line less."""
    lines = SITE.splitlines(keepends=True)
    return [SITE, *(b''.join(lines[:i] + lines[i + 1:]) for i in range(len(lines)))]


def examples():
    """The command lines that the helps print."""
    for path in sorted(glob.glob(os.path.join(build.ROOT, 'examples', 'fathom', '**', '*.c'), recursive=True)):
        with open(path, encoding='utf-8') as file:
            yield from re.findall(r'^\s+"  fathom ([a-z][^"\\]*)', file.read(), re.M)


@makes('options')
def options(frames):
    found = [b'\x46' + '\n'.join(line.split()).encode() for line in examples()]
    found += [b'\0' + text for text in (b'12', b'4294967295', b'2-9', b'0-0')]
    found += [b'\x20\0\x64' + text for text in (b'100', b'101', b'5-100', b'5-101')]  # from 0 to 100
    found += [b'\1' + text for text in (b'192.168.1.20', b'[fd00::20]:502', b'host:1502')]
    found += [bytes([2 | model << 4, row]) + text for model in range(3) for row in range(20)
              for text in (b'5', b'on', b'19200', b'positive')]
    found += [b'\3near<500/600,unknown=on,no-response=off,hold=200/1000,unknown-after=5000,no-target=unknown',
              b'\3far>500,unknown=off,no-response=off',
              b'\4mounting=2500,height=2000,capacity=5000,shape=horizontal-cylinder,offset=-5',
              b'\4mounting=2500,height=2000,shape=table,points=500:400/1500:4000/2000:5000',
              b'\5tank-1=a16:2:modbus@/dev/ttyUSB0,baud=9600,parity=none', b'\5hps167s:7@tcp:host:502',
              b'\5a16::pwm@gpiochip0,trigger=17,echo=27', b'\5a05:auto']
    return found

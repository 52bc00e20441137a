# SPDX-License-Identifier: MIT
"""The completions of bash, zsh and fish."""
import bash
import fish
import zsh

DEVICES = ('/dev/ttyUSB*', '/dev/ttyACM*', '/dev/serial/by-id/*', '/dev/gpiochip*')  # what --port names, before files
HEADER = 'Completion of fathom, made from its help. Do not edit.'


def files(tool):
    """{where each lies: text}"""
    return {'bash/fathom': bash.text(tool, HEADER, DEVICES), 'zsh/_fathom': zsh.text(tool, HEADER, DEVICES),
            'fish/fathom.fish': fish.text(tool, HEADER, DEVICES)}

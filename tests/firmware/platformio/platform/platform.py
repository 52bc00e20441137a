# SPDX-License-Identifier: MIT
from platformio.platform.base import PlatformBase


class SystemPlatform(PlatformBase):
    """All that it needs stands in builder/main.py."""

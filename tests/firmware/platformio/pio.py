# SPDX-License-Identifier: MIT
"""PlatformIO's command, but that it knows the one licence that library.json names: it looks each up in a list on the
net, for which no test may wait."""
import sys

from platformio.__main__ import main
from platformio.package.manifest.schema import ManifestSchema

ManifestSchema.load_spdx_licenses = staticmethod(lambda: {'licenses': [{'licenseId': 'MIT'}]})

if __name__ == '__main__':
    sys.exit(main(['pio', *sys.argv[1:]]))

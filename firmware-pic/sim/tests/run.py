# SPDX-License-Identifier: GPL-2.0-or-later
"""All tests of the bridge: `python3 run.py FOLDER_OF_THE_BUILD [unittest's arguments]`."""

import os
import sys
import unittest

if __name__ == "__main__":
    here = os.path.dirname(os.path.abspath(__file__))
    os.environ["RSAPIEN_GPSIM_OUT"] = os.path.abspath(sys.argv[1])
    sys.path.insert(0, here)
    sys.dont_write_bytecode = True
    if len(sys.argv) > 2:
        unittest.main(module=None, argv=sys.argv[1:])
    tests = unittest.defaultTestLoader.discover(here)
    sys.exit(not unittest.TextTestRunner(verbosity=1).run(tests).wasSuccessful())

"""Runs several tests of notebooks and reports in one process: NAME stands for NAME_test.py, which also runs alone.

    pages_test.py OUT NAME...
"""
import sys

import pages

pages.main([f"{name}_test" for name in sys.argv[2:]])

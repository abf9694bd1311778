# SPDX-License-Identifier: MIT
"""The wheel holds a library of one platform, and nothing of one version of Python."""

import os
import re
from pathlib import Path

from setuptools import Distribution, setup
from wheel.bdist_wheel import bdist_wheel

VERSION = re.search(r"^VERSION = '(.*)'", Path("grobo/_version.py").read_text(), re.M)


class Wheel(bdist_wheel):
    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        platform = os.environ.get("GROBO_PLATFORM") or super().get_tag()[2]
        return "py3", "none", platform


class Platform(Distribution):
    def has_ext_modules(self):
        return True


setup(version=VERSION.group(1), cmdclass={"bdist_wheel": Wheel}, distclass=Platform)

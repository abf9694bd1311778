#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the package says of itself: its examples run, and everything public is explained."""

import doctest
import inspect
import unittest

import grobo
import grobo.errors
import grobo.mcap
import grobo.motion
import grobo.robot

MODULES = (grobo, grobo.motion, grobo.robot, grobo.errors, grobo.description, grobo.mcap)


def load_tests(loader, tests, pattern):
    """The examples in docstrings, each of which is a test."""
    for module in MODULES:
        tests.addTests(doctest.DocTestSuite(module))
    return tests


class Docs(unittest.TestCase):
    def test_all_that_is_public_is_explained(self):
        bare = []
        for name in grobo.__all__:
            thing = getattr(grobo, name)
            bare += [] if inspect.getdoc(thing) else [name]
            for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                explained = getattr(value, "__doc__", None)
                asked = callable(value) or isinstance(value, (property, classmethod, staticmethod))
                if asked and not member.startswith("_") and not explained:
                    bare.append(f"{name}.{member}")
        self.assertEqual(bare, [])

    def test_there_are_examples(self):
        found = sum(len(one.examples) for module in MODULES
                    for one in doctest.DocTestFinder().find(module))
        self.assertGreater(found, 15)


if __name__ == "__main__":
    unittest.main()

# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Plants violations in a temporary tree and checks that the style checks catch each one."""

import tempfile
import unittest
from pathlib import Path

import arrows
import formatting
import limits
import sources

ARCHITECTURE = """
| room | holds | may use |
|------|-------|---------|
| `core/base` | status | |
| `core/cloud` | frames | `base` |
| `idl/wire` | types | `base` |
| `client` | SDK | `base` `idl/wire` |

| library | headers | only in |
|---------|---------|---------|
| PCL | `pcl/` | `core/*/*_pcl.cpp` |
| Fast DDS | `fastdds/ fastrtps/` | `idl/wire/*` |
"""
SPDX = ("// SPDX-FileCopyrightText: 2026 The bpa authors\n"
        "// SPDX-License-Identifier: Apache-2.0\n")


SECURITY = """
| input | limit | beyond it | where |
|-------|-------|-----------|-------|
| a name | `247` characters | refused | `idl/wire/names.cpp` `kMaxName` |
| requests | `8` | busy | `config/server.yaml` `queue.requests` |
"""


class StyleChecks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("ARCHITECTURE.md", ARCHITECTURE)
        self.write("core/base/status.hpp", SPDX)
        for path in ("core/cloud/user.cpp", "idl/wire/user.cpp"):
            self.write(path, SPDX + '#include "core/base/status.hpp"\n')
        self.write("client/src/user.cpp", SPDX + '#include "core/base/status.hpp"\n'
                                                 '#include "idl/wire/qos.hpp"\n')

    def write(self, path, content):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(content, encoding="utf-8")

    def expect(self, check, path, content, problem):
        """Fine before; after the file is written, the one problem holds these words."""
        self.assertEqual(check.check(self.root), [])
        self.write(path, content)
        problems = check.check(self.root)
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(problem, problems[0])
        (self.root / path).unlink()

    def write_limits(self):
        self.write("SECURITY.md", SECURITY)
        self.write("idl/wire/names.cpp", SPDX + "constexpr std::size_t kMaxName = 247;\n")
        self.write("config/server.yaml", "queue:\n  # Of all.\n  requests: 8\n")

    def test_limits_of_security_are_those_of_the_code(self):
        self.write_limits()
        self.expect(limits, "idl/wire/more.cpp", "constexpr int kMaxMore = 1 << 4;\n", "kMaxMore")
        self.expect(limits, "idl/wire/most.hpp", "inline constexpr int kMostThings{7};\n",
                    "kMostThings")
        for path, text, words in [
                ("idl/wire/names.cpp", "constexpr std::size_t kMaxName{248};\n", "248"),
                ("idl/wire/names.cpp", "", "no kMaxName"),
                ("config/server.yaml", "queue:\n  requests: 9\n", "9"),
                ("SECURITY.md", "nothing", "no table")]:
            self.write_limits()
            self.expect_changed(path, text, words)

    def expect_changed(self, path, text, words):
        self.assertEqual(limits.check(self.root), [])
        self.write(path, text)
        problems = limits.check(self.root)
        self.assertTrue(any(words in problem for problem in problems), problems)

    def test_allowed_arrows_pass(self):
        self.write("core/cloud/frame.cpp", '#include "core/base/status.hpp"\n#include <vector>\n')
        self.write("core/cloud/b.cpp", '#include "core/cloud/private/x.hpp"\n')
        self.write("core/cloud/a_pcl.cpp", '#include <pcl/io.h>\n#include "core/cloud/frame.hpp"\n')
        self.write("client/src/a.cpp", '#include <bpa/client.hpp>\n#include "idl/wire/a.hpp"\n')
        self.assertEqual(arrows.check(self.root), [])

    def test_forbidden_arrows(self):
        for path, include, problem in (
                ("core/base/a.cpp", "<core/cloud/frame.hpp>", "core/base may not include"),
                ("core/base/a.cpp", '"../cloud/frame.hpp"', "a path from its root"),
                ("core/base/a.cpp", '"core/cloud/frame.hpp"', "core/base may not include"),
                ("core/cloud/a.hpp", '"idl/wire/qos.hpp"', "core/cloud may not include"),
                ("client/src/a.cpp", '"core/cloud/frame.hpp"', "client may not include"),
                ("core/cloud/a.cpp", '"core/util/x.hpp"', "lies in no room"),
                ("core/cloud/a.cpp", '"core/base/private/x.hpp"', "is private to core/base"),
                ("core/cloud/a.cpp", "<pcl/io.h>", "PCL is allowed only in core/*/*_pcl.cpp"),
                ("client/src/a.cpp", "<fastrtps/x.h>", "Fast DDS is allowed only in idl/wire/*")):
            with self.subTest(path=path, include=include):
                self.expect(arrows, path, f"  # include {include}\n", problem)

    def test_file_outside_the_rooms(self):
        self.expect(arrows, "core/util/a.hpp", "", "lies in no room")

    def test_forbidden_uses(self):
        self.expect(arrows, "core/base/CMakeLists.txt",
                    "bpa_room(base SOURCES a.cpp\n  USES cloud PUBLIC_LIBS x)\n",
                    "core/base may not use cloud")

    def test_permission_that_is_not_used(self):
        self.expect(arrows, "ARCHITECTURE.md",
                    ARCHITECTURE.replace("SDK | `base`", "SDK | `base` `cloud`"),
                    "client may use core/cloud, but includes nothing of it")

    def test_uses_without_an_include(self):
        self.expect(arrows, "ARCHITECTURE.md", ARCHITECTURE.replace(
            "| `idl/wire`", "| `core/align` | alignment | `cloud` |\n| `idl/wire`", 1),
                    "core/align may use core/cloud")
        self.write("ARCHITECTURE.md", ARCHITECTURE)
        self.write("core/cloud/user.cpp", SPDX)
        self.write("core/cloud/CMakeLists.txt", "bpa_room(cloud SOURCES user.cpp USES base)\n")
        self.assertEqual(arrows.check(self.root), [
            "core/cloud/CMakeLists.txt: core/cloud includes nothing of base, which it says it USES",
            "ARCHITECTURE.md: core/cloud may use core/base, but includes nothing of it"])

    def test_table_with_an_upward_arrow(self):
        self.expect(arrows, "ARCHITECTURE.md", ARCHITECTURE.replace("| status | |",
                                                                    "| status | `cloud` |"),
                    "no room further up")

    def test_missing_licence(self):
        self.write("core/base/a.cpp", "int a;\n")
        self.assertEqual(len(sources.check(self.root)), 2)

    def test_wrong_licence(self):
        self.expect(sources, "core/base/a.cpp", SPDX.replace("Apache-2.0", "MIT"), "Apache-2.0")

    def test_long_file(self):
        self.expect(sources, "core/base/a.cpp", SPDX + "int a;\n" * 600, "602 lines")
        self.write("core/base/a.cpp", SPDX + "// generated, do not edit\n" + "int a;\n" * 600)
        self.assertEqual(sources.check(self.root), [])

    def test_machine_paths(self):
        for folder in ("work", "home", "root"):
            self.expect(sources, "config/a.yaml", f"\nlibrary: /{folder}/me/library\n", "a.yaml:2")
        self.write("config/a.yaml", "see https://example.org/home/page and build/work/x\n")
        self.assertEqual(sources.check(self.root), [])

    @unittest.skipIf(formatting.clang_format() is None, "no clang-format 14")
    def test_formatting(self):
        self.write(".clang-format", "BasedOnStyle: Google\n")
        self.expect(formatting, "core/base/a.cpp", SPDX + "int  a ;\n", "core/base/a.cpp")


if __name__ == "__main__":
    unittest.main()

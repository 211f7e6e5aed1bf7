"""Runs the steps of ./reproduce with programs that do nothing: what a killed run finished is kept, and a level that is not there is named.

    steps_test.py
"""
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = """#!/bin/bash
# demo   a result for this test
. "$(dirname "$0")/shared.sh"
write() { echo "name" >"$part/table.csv"; echo "$1" >>"$part/table.csv"; echo "$1" >>ran.txt; }
wait_for() { write "$1"; while [ ! -e "$1" ]; do sleep .1; done; }
fail() { write "$1"; false; echo "not reached" >>ran.txt; }
steps() {
  local name seconds=shadow title=shadow
  step --beside 'beside: one' write beside
  step 'first' write first
  for name in $(present oa_koth1.cells oa_thor.faces); do step "level $name" write "$name"; done
  step --memory 1000000 'large' write large
  step 'waits' wait_for gate
  if [ -e fails ]; then step 'fails' fail fails; fi
  step 'last' write last
}
run_steps
"""
SETUP = "\ninstall_packages() { :; }\nbuild() { :; }\n"


class Steps(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for name in ("reproduce", "bench/reproduce/shared.sh", ".ci/setup.sh"):
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.root / name)
        with open(self.root / ".ci/setup.sh", "a") as setup:
            setup.write(SETUP)
        self.write("bench/reproduce/demo.sh", SCRIPT)
        self.write("bench/reproduce/demo_report.py", "print('the report')\n")
        self.write("fetch-levels", "#!/bin/bash\nexit 3\n").chmod(0o755)
        self.write("results/demo/steps.csv", "# machine: M\nstep,minutes\nfirst,2\nwaits,3\n")
        self.write("cache/openarena-081-maps/usr/share/games/openarena/baseoa/pak1-maps.pk3", "")
        for program in ("vismat", "bench"):
            self.write(f"build/release/{program}", "")

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def start(self, *options):
        environment = os.environ | {"VISMAT_CACHE": str(self.root / "cache")}
        return subprocess.Popen(["./reproduce", "demo", "--full", *options], cwd=self.root, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def until(self, condition):
        for _ in range(600):
            if condition():
                return
            time.sleep(.05)
        self.fail("waited 30 s")

    def ran(self):
        path = self.root / "ran.txt"
        return path.read_text().split() if path.exists() else []

    def test_goes_on_after_a_kill(self):
        run = self.start()
        self.until(lambda: "gate" in self.ran())
        second, _ = self.start().communicate()
        self.assertIn("another run is making demo", second)
        run.send_signal(signal.SIGKILL)
        told = run.communicate()[0]  # ends only when no step is left that writes to it
        self.assertIn("2 min 00 s  first\n", told)
        self.assertIn("5 min 00 s  altogether, as measured on: M\n", told)
        self.assertIn("not measured: oa_thor: package openarena-088-data was not fetched\n", told)
        self.assertFalse((self.root / "out/demo/table.csv").exists())

        (self.root / "gate").touch()
        told, _ = self.start().communicate()
        self.assertIn("3 of 6 steps were finished before", told)
        self.assertIn("3 min 00 s  to go", told)
        self.assertTrue(told.endswith("the report\n"), told)
        self.assertEqual(sorted(self.ran()), sorted(["beside", "first", "oa_koth1.cells", "gate", "gate", "last"]))
        self.assertEqual((self.root / "out/demo/table.csv").read_text().split(), ["name", "beside", "first", "oa_koth1.cells", "gate", "last"])
        left_out = (self.root / "out/demo/not_measured.txt").read_text().splitlines()
        self.assertEqual(len(left_out), 2, left_out)
        self.assertTrue(left_out[1].startswith("large: it takes 1000000 GB of memory"), left_out)

        self.write("build/release/bench", "another program")
        self.start().communicate()
        self.assertEqual(self.ran().count("first"), 2)
        self.start("--afresh").communicate()
        self.assertEqual(self.ran().count("first"), 3)
        self.assertEqual((self.root / "out/demo/table.csv").read_text().split().count("first"), 1)

    def test_a_step_that_fails_ends_the_run_and_leaves_no_table(self):
        (self.root / "gate").touch()
        (self.root / "fails").touch()
        run = self.start()
        told, _ = run.communicate()
        self.assertEqual(run.returncode, 1)
        self.assertIn("a step failed", told)
        self.assertNotIn("not", self.ran())
        self.assertNotIn("last", self.ran())
        self.assertTrue((self.root / "out/demo/full/first/table.csv").exists())
        self.assertFalse((self.root / "out/demo/full/fails").exists())


if __name__ == "__main__":
    unittest.main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel (.ci/install/makeWheel), installed by pip in a virtual environment, needs neither compiler, gmsh, MPI nor libraries of the
system: a gas and grains run, are drawn and reported."""
import glob
import os
import re
import shutil
import unittest

from tests.cases import harness
from tests.install import outside
from tests.install.outside import BUILD, COMMANDS, PROGRAMS, call
from tests.install.test_install import missing

# All that is in PATH beside the wheel's own folder: what scripts call on any system. No compiler, gmsh, mpirun or lmp.
TOOLS = "sh env cmp date dirname find getconf grep mv rm sed setpriv setsid tail".split()
SYSTEM = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|pthread|gcc_s))\.so\.\d+$")
LACKING = missing() or next((name for name in ("strip", "patchelf", "objdump", "ompi_info", "cmake") if not shutil.which(name)), None)


@unittest.skipIf(LACKING, f"{LACKING} is not there")
@unittest.skipUnless(outside.INSTALLS, "no build of CMake to pack")
@unittest.skipIf(outside.INSTALLS and outside.cached("HAFF_SANITIZE") == "ON", "sanitizers want libraries of the compiler")
class Wheel(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.wheel = call(os.path.join(harness.SOURCE, ".ci/install/makeWheel"), BUILD, os.path.join(cls.folder, "dist"), cwd=cls.folder).strip()
        cls.venv, tools = os.path.join(cls.folder, "venv"), os.path.join(cls.folder, "tools")
        cls.bin = os.path.join(cls.venv, "bin")
        call("/usr/bin/python3", "-m", "venv", "--without-pip", "--system-site-packages", cls.venv, cwd=cls.folder)
        call("/usr/bin/python3", "-m", "pip", "--python", cls.venv, "install", "--no-deps", cls.wheel, cwd=cls.folder)
        os.mkdir(tools)
        for name in TOOLS:
            os.symlink(shutil.which(name), os.path.join(tools, name))
        cls.path = f"{cls.bin}:{tools}"

    def test_name(self):
        """The name says for which systems the wheel is: any Python 3, this processor, this glibc or a later one."""
        self.assertRegex(os.path.basename(self.wheel), rf"^haff-{re.escape(outside.VERSION)}-py3-none-manylinux_2_\d+_\w+\.whl$")

    def test_libraries(self):
        """Whatever programs and plugins load lies in the environment, but for glibc and libgcc. Their licences are there."""
        home = os.path.join(self.venv, "lib", "haff")
        plugins = glob.glob(os.path.join(home, "openmpi", "**", "mca_*.so"), recursive=True)
        self.assertLessEqual(set(PROGRAMS + COMMANDS), set(os.listdir(self.bin)))
        self.assertLessEqual({"mca_pml_ob1.so", "mca_btl_vader.so", "mca_btl_tcp.so", "mca_pmix_ext3x.so"}, set(map(os.path.basename, plugins)))
        objects = [*(os.path.join(self.bin, p) for p in PROGRAMS), os.path.join(home, "haffgas.so"), os.path.join(home, "openmpi/bin/mpirun"), *plugins, *glob.glob(os.path.join(home, "libs", "*"))]
        said = re.split(r"^(/.*):\s+file format.*$", call("objdump", "-p", *objects, cwd=self.folder), flags=re.M)
        self.assertEqual(set(objects), set(said[1::2]))
        for path, text in zip(said[1::2], said[2::2]):
            for name in re.findall(r"^ *NEEDED +(\S+)", text, re.M):
                self.assertTrue(SYSTEM.match(name) or os.path.exists(os.path.join(home, "libs", name)), f"{path} needs {name}")
            where = re.search(r"^ *R(?:UN)?PATH +\$ORIGIN/(\S+)", text, re.M)[1]
            self.assertEqual(os.path.realpath(os.path.join(os.path.dirname(path), where)), os.path.realpath(os.path.join(home, "libs")), path)
        licences = {os.path.basename(path) for path in glob.glob(os.path.join(self.venv, "lib/python3*/site-packages/haff-*.dist-info/licenses/*"))}
        self.assertTrue(any("openmpi" in name for name in licences) and any("p4est" in name for name in licences), licences)
        self.assertEqual([], outside.traces(home))
        self.assertTrue(os.path.exists(os.path.join(self.venv, "share/haff/editors/vscode/package.json")))

    def test_runs(self):
        """From nothing to pictures and a report: a gas on one rank and on two, with the same bits, and grains."""
        run = lambda *command, cwd: call(*command, cwd=cwd, PATH=self.path)
        run(os.path.join(self.bin, "newCase"), "gas", "-box", "2x1", "-cells", "24x12", "-end", "0.2", cwd=self.folder)
        run(os.path.join(self.bin, "newCase"), "grains", "-box", "20x10", "-application", "granularMD", "-grains", "disks", "-diameter", "1", "-end", "0.2", cwd=self.folder)
        gas, pair, grains = (os.path.join(self.folder, name) for name in ("gas", "pair", "grains"))
        harness.edit(gas, "system/controlDict", writeInterval=0.1)
        shutil.copytree(gas, pair)
        said = run(os.path.join(gas, "Allrun"), cwd=gas)
        self.assertRegex(said, r"(?s)end at time 0.2\b.*The report is ")
        self.assertTrue(os.path.exists(re.search(r"The report is (.*)", said)[1]))
        self.assertIn("end at time 0.2", run(os.path.join(self.bin, "granularMD"), "-case", grains, cwd=grains))
        picture = run(os.path.join(self.bin, "haffPlot"), ".", cwd=grains).split()[-1]
        self.assertGreater(os.path.getsize(os.path.join(grains, picture)), 10000)
        self.assertIn("end at time 0.2", run(os.path.join(self.bin, "granularGas"), "-case", pair, "-np", "2", cwd=self.folder))
        steps = "import haff; gas = haff.Gas('stepped'); gas.advance(0.1); print(gas.time, gas.alpha.shape)"
        shutil.copytree(gas, os.path.join(self.folder, "stepped"), ignore=shutil.ignore_patterns("0.[12]*"))
        self.assertEqual("0.1 (288,)\n", run(os.path.join(self.bin, "python3"), "-c", steps, cwd=self.folder))
        fields = lambda case: {name: outside.texts(os.path.join(case, "0.2"))[name] for name in ("alpha", "U", "T")}
        self.assertEqual(fields(gas), fields(pair))


if __name__ == "__main__":
    unittest.main()

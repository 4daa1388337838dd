# SPDX-License-Identifier: GPL-3.0-or-later
"""The packages that cpack makes: apt knows what they need, they hold what Debian asks for and no path of the build, and a case runs
from them in a root in which there is nothing else of haff."""
import glob
import os
import re
import shutil
import subprocess
import tarfile
import unittest

from tests.cases import harness, runs
from tests.install import outside
from tests.install.outside import COMMANDS, LIBRARIES, MODULE, PROGRAMS, call
from tests.postprocessing.runs.test_run import tube

TOOLS = "cpack dpkg-deb dpkg-shlibdeps apt-get gzip readelf".split()
# A new root of $1: the system's /usr below that of $2, as overlay; the rest of the arguments is called there.
ENTER = """set -e
new=$1 clean=$2; shift 2
mkdir -p "$new/usr" "$new/etc" "$new/dev" "$new/proc" "$new/tmp" "$new/home"
for name in bin lib lib64 sbin; do ! [ -L /$name ] || ln -sfn usr/$name "$new/$name"; done
mount -t overlay overlay -o "lowerdir=$clean/usr:/usr" "$new/usr"
for name in etc dev proc; do mount --rbind /$name "$new/$name"; done
cd /
exec chroot "$new" "$@"
"""


@unittest.skipUnless(outside.INSTALLS and all(map(shutil.which, TOOLS)), f"no build of CMake to pack, or not all of {' '.join(TOOLS)}")
class Debian(harness.Folder, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        """The packages of test_guide, which CTest runs before; else cpack's without the build that it begins with. All are unpacked into one root."""
        super().setUpClass()
        cls.root, made = os.path.join(cls.folder, "root"), os.environ.get("HAFF_PACKAGES", "")
        if not os.path.isdir(made):
            made = cls.folder
            call("cpack", "--config", os.path.join(outside.BUILD, "CPackConfig.cmake"), "-D", "CPACK_CMAKE_GENERATOR=Ninja", "-B", made, cwd=made)
        cls.packages = {os.path.basename(p).split("_")[0]: p for p in glob.glob(os.path.join(made, "*.deb"))}
        for path in cls.packages.values():
            call("dpkg-deb", "-x", path, cls.root, cwd=cls.folder)

    def field(self, package, name):
        return call("dpkg-deb", "-f", self.packages[package], name, cwd=self.folder).strip()

    def test_packages(self):
        """Three, with the version of the project; PETSc is needed by its own one alone, which goes with the same version."""
        self.assertEqual(set(self.packages), {"haff", "libhaff-dev"} | ({"haff-implicit"} if MODULE else set()))
        for package in self.packages:
            self.assertEqual(self.field(package, "Version"), outside.VERSION)
            self.assertGreater(len(self.field(package, "Description").split("\n")), 1)
        self.assertNotIn("petsc", self.field("haff", "Depends"))
        for needed in ("python3-numpy", "python3-matplotlib", "openmpi-bin", "libopenmpi", "libp4est", "libmetis", "liblapacke", "libdeflate", "libc6"):
            self.assertIn(needed, self.field("haff", "Depends"))
        if MODULE:
            self.assertRegex(self.field("haff-implicit", "Depends"), rf"haff \(= {re.escape(outside.VERSION)}\).*libpetsc")
        with open(os.path.join(harness.SOURCE, ".ci", "setup"), encoding="utf-8") as file:
            wanted = set(re.findall(r"\b(lib\w+-dev|zlib1g-dev)\b", re.search(r'^build_packages="([^"]*)"', file.read(), re.M)[1])) - {"libc6-dev"}
        self.assertEqual(set(self.field("libhaff-dev", "Depends").split(", ")), wanted)

    def test_apt(self):
        """apt resolves them; it knows each package that they recommend and suggest."""
        said = call("apt-get", "install", "--simulate", "--no-install-recommends", *self.packages.values(), cwd=self.folder)
        for package in self.packages:
            self.assertRegex(said, rf"(?m)^Inst {package} \({re.escape(outside.VERSION)}")
        names = set(re.split(r", | \| ", self.field("haff", "Recommends") + ", " + self.field("haff", "Suggests"))) - {"haff-implicit", "libhaff-dev"}
        self.assertGreater(len(names), 5)
        shown = subprocess.run(["apt-cache", "show", "hello", *names], capture_output=True, text=True).stdout
        known = set(re.findall(r"^Package: (\S+)$", shown, re.M))
        if "hello" not in known:
            self.skipTest("apt has no lists of packages: apt-get update")
        self.assertEqual(set(), names - known)

    def test_contents(self):
        """Everything is below /usr and root's, with plain permissions; copyright, changelog and compressed manual pages; nothing names
        the build; programs are stripped and look for libraries where the system has them; no command of the system is hidden."""
        for package, path in self.packages.items():
            archive = subprocess.run(["dpkg-deb", "--fsys-tarfile", path], capture_output=True, check=True).stdout
            with open(os.path.join(self.folder, package + ".tar"), "wb") as file:
                file.write(archive)
            with tarfile.open(os.path.join(self.folder, package + ".tar")) as tar:
                members = {m.name.removeprefix("./"): m for m in tar.getmembers()}
            for name, m in members.items():
                self.assertTrue(name in ("", ".", "usr") or name.startswith("usr/"), name)
                self.assertEqual((0, 0), (m.uid, m.gid), name)
                if not m.issym():
                    run = m.isdir() or name.startswith("usr/bin/") or name == "usr/lib/haff/mpirun"
                    self.assertEqual(0o755 if run else 0o644, m.mode & 0o7777, name)
            for name in ("copyright", "changelog.gz"):
                self.assertIn(f"usr/share/doc/{package}/{name}", members)
        self.assertEqual(set(PROGRAMS + COMMANDS), set(os.listdir(os.path.join(self.root, "usr/bin"))))
        pages = os.listdir(os.path.join(self.root, "usr/share/man/man1"))
        self.assertTrue({p + ".1.gz" for p in PROGRAMS + COMMANDS} <= set(pages))
        self.assertTrue(all(p.endswith(".1.gz") for p in pages))
        self.assertEqual([], outside.traces(self.root))
        for name in [*("bin/" + p for p in PROGRAMS), *("lib/haff/" + name for name in LIBRARIES)]:
            said = call("readelf", "-d", "-S", os.path.join(self.root, "usr", name), cwd=self.folder)
            self.assertNotRegex(said, r"RUNPATH|RPATH|\.symtab|\.debug", name)

    def cases(self, folder):
        """A tube, and, where the module was built, one that asks for it."""
        tube(os.path.join(folder, "tube"))
        if MODULE:
            runs.add(runs.make(os.path.join(folder, "implicit"), (24, 1, 1), 0.002, viscous=True), "system/fvSolution", "diffusion { type implicit; }\n")

    def test_run(self):
        """Cases run from where the packages are unpacked, on two ranks, too, and by the commands."""
        binaries = os.path.join(self.root, "usr/bin")
        here = os.path.join(self.folder, "here")
        self.cases(here)
        self.assertIn("end at time 0.05", call("granularGas", "-case", "tube", "-np", "2", cwd=here, path=binaries))
        if MODULE:
            self.assertIn("end at time 0.002", call("granularGas", "-case", "implicit", cwd=here, path=binaries))
        self.assertIn("restitution=0.8", call("haff", "run", "tube", "constant/granularProperties:grain/restitution=0.8", cwd=here, path=binaries))
        self.assertRegex(call("haffPlot", "tube", "rho", cwd=here, path=binaries), r"(?m)/rho\.png$")

    def test_clean_root(self):
        """The same in a root that holds the system and what was unpacked, and nothing of the tree."""
        enter = ["unshare", "-m", "sh", "-c", ENTER, "enter", os.path.join(self.folder, "new"), self.root]
        if not shutil.which("unshare") or subprocess.run([*enter, "true"], capture_output=True).returncode:
            self.skipTest("this system lets nobody make a root: unshare and overlays are not allowed")
        self.cases(os.path.join(self.folder, "new", "home"))
        inside = lambda *words: call(*enter, "env", "-i", "PATH=/usr/bin:/bin", "MPLBACKEND=Agg", "OMP_NUM_THREADS=1", *words, cwd=self.folder)
        self.assertEqual("", inside("find", "/home", "-name", "CMakeLists.txt"))
        self.assertIn("end at time 0.05", inside("granularGas", "-case", "/home/tube", "-np", "2"))
        if MODULE:
            self.assertIn("end at time 0.002", inside("granularGas", "-case", "/home/implicit"))
        self.assertIn("in /usr/bin", inside("haff", "-version"))
        self.assertRegex(inside("haffPlot", "/home/tube", "rho"), r"(?m)/rho\.png$")


if __name__ == "__main__":
    unittest.main()

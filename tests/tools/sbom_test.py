#!/usr/bin/env python3
"""tools/sbom: the list of what a package links has the shape of SPDX 2.3, names every library that is
loaded with the version that dpkg knows, and is the same whenever and wherever it is made.

usage: sbom_test.py TACTUSD BUILD_FOLDER
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = str(pathlib.Path(sys.argv.pop(2)).resolve())
TACTUSD = pathlib.Path(sys.argv.pop(1)).resolve()
CONTROL = """Package: tactusd
Version: 0.1.0
Architecture: amd64
Maintainer: Tactus developers <tactus@example.org>
Description: of the test
"""
LINKS = {"DYNAMIC_LINK", "DEPENDS_ON", "STATIC_LINK"}


def call(*command, **more):
    return subprocess.run(command, check=True, capture_output=True, text=True, **more).stdout


def package(folder, program):
    tree = folder / "tree"
    (tree / "DEBIAN").mkdir(parents=True)
    (tree / "DEBIAN/control").write_text(CONTROL)
    (tree / "usr/sbin").mkdir(parents=True)
    shutil.copy2(program, tree / "usr/sbin/tactusd")
    path = folder / "tactusd_0.1.0_amd64.deb"
    call("dpkg-deb", "-Znone", "--build", "--root-owner-group", str(tree), str(path))
    return path


def sbom(deb, **environment):
    return subprocess.run([str(ROOT / "tools/sbom"), str(deb), BUILD], cwd=ROOT, capture_output=True,
                          text=True, check=False, env={**os.environ, **environment})


class SbomTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.deb = package(cls.folder, TACTUSD)
        done = sbom(cls.deb, SOURCE_DATE_EPOCH="86400")
        assert done.returncode == 0, done.stderr
        cls.text = done.stdout
        cls.document = json.loads(cls.text)
        cls.packages = {entry["name"]: entry for entry in cls.document["packages"]}

    def test_has_the_shape_of_spdx(self):
        document = self.document
        self.assertEqual(document["spdxVersion"], "SPDX-2.3")
        self.assertEqual(document["dataLicense"], "CC0-1.0")
        self.assertEqual(document["SPDXID"], "SPDXRef-DOCUMENT")
        self.assertRegex(document["documentNamespace"], r"^https://[^#\s]+$")
        self.assertRegex(document["creationInfo"]["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        for creator in document["creationInfo"]["creators"]:
            self.assertRegex(creator, r"^(Tool|Organization|Person): \S")
        ids = [entry["SPDXID"] for entry in document["packages"]]
        self.assertEqual(len(ids), len(set(ids)))
        for entry in document["packages"]:
            self.assertRegex(entry["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertEqual(entry["downloadLocation"], "NOASSERTION")
            self.assertIs(entry["filesAnalyzed"], False)
            self.assertTrue(entry["versionInfo"])
            self.assertRegex(entry["supplier"], r"^Organization: \S")
            self.assertRegex(entry["externalRefs"][0]["referenceLocator"], r"^pkg:deb/debian/\S+$")
        for relation in document["relationships"]:
            self.assertIn(relation["relationshipType"], LINKS | {"DESCRIBES"})
            self.assertIn(relation["spdxElementId"], [*ids, "SPDXRef-DOCUMENT"])
            self.assertIn(relation["relatedSpdxElement"], ids)
        related = {relation["relatedSpdxElement"] for relation in document["relationships"]}
        self.assertEqual(related, set(ids), "an element that nothing leads to")

    def test_licences_are_expressions_whose_references_are_there(self):
        extracted = {entry["licenseId"] for entry in self.document["hasExtractedLicensingInfos"]}
        used = set()
        for name, entry in self.packages.items():
            with self.subTest(name):
                declared = entry["licenseDeclared"]
                self.assertRegex(declared, r"^[A-Za-z0-9.-]+( (AND|OR) [A-Za-z0-9.-]+)*$")
                used |= {word for word in declared.split() if word.startswith("LicenseRef-")}
                if declared == "NOASSERTION":
                    self.assertRegex(entry["licenseComments"], r"^Debian: /usr/share/doc/\S+copyright")
        self.assertEqual(used, extracted)

    def test_names_every_library_that_is_loaded_as_dpkg_knows_it(self):
        loaded = re.findall(r" => (/\S+)", call("ldd", str(TACTUSD)))
        self.assertGreater(len(loaded), 5)
        for path in loaded:
            names = {path, os.path.realpath(path), re.sub("^/usr", "", os.path.realpath(path))}
            owner = next(done.stdout.split(":")[0] for done in
                         (subprocess.run(["dpkg-query", "-S", name], capture_output=True, text=True,
                                         check=False) for name in sorted(names))
                         if done.returncode == 0)
            self.assertIn(owner, self.packages, path)
        for name, entry in self.packages.items():
            if name != "tactusd":
                self.assertEqual(entry["versionInfo"],
                                 call("dpkg-query", "-W", "-f", "${Version}\n", name).split()[0])

    def test_names_what_is_compiled_in_and_no_more(self):
        static = {relation["relatedSpdxElement"] for relation in self.document["relationships"]
                  if relation["relationshipType"] == "STATIC_LINK"}
        self.assertLessEqual({"SPDXRef-libeigen3-dev", "SPDXRef-nlohmann-json3-dev"}, static)
        self.assertFalse([name for name in self.packages if re.search("gtest|cgal|mujoco|httplib", name)])

    def test_is_the_same_whenever_and_wherever_it_is_made(self):
        again = sbom(self.deb, SOURCE_DATE_EPOCH="86400", TZ="Asia/Tokyo", LANG="de_DE.UTF-8").stdout
        self.assertEqual(again, self.text)
        self.assertEqual(self.document["creationInfo"]["created"], "1970-01-02T00:00:00Z")

    def test_a_package_without_a_program_is_refused_in_one_line(self):
        (self.folder / "text").write_text("no program")
        (self.folder / "other").mkdir()
        done = sbom(package(self.folder / "other", self.folder / "text"))
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^sbom: \S+: holds no program\n$")


if __name__ == "__main__":
    unittest.main()

"""The plugin's XML as a user meets it: the menu, names, help and options that show when they matter."""

import re
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
XML = ROOT / "Wrapping" / "ParaView" / "MultiLabelInterfaceMesher.xml"
# Names in classes that are no options of the user interface.
NOT_OPTIONS = {"BallsConnection", "BallsData", "AbortExecute"}


def spaced(name):
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)


def setters(name):
    """Names X of the members SetX of a class and of its own superclass, from the headers."""
    text = (ROOT / "Filters" / f"{name}.h").read_text(encoding="utf-8")
    names = set(re.findall(r"vtkSet(?:Clamp)?Macro\((\w+),", text))
    if "public vtkMultiLabelImageAlgorithm" in text:
        names |= setters("vtkMultiLabelImageAlgorithm")
    return names - NOT_OPTIONS


class TestDescription(unittest.TestCase):
    def setUp(self):
        groups = {g.get("name"): g for g in ElementTree.parse(XML).getroot()}
        self.bases = {p.get("name"): p for p in groups["internal_filters"]}
        self.filters = list(groups["filters"])

    def parts(self, proxy):
        """The proxy's elements and those of its base."""
        base = self.bases.get(proxy.get("base_proxyname"), ())
        return list(base) + list(proxy)

    def properties(self, proxy):
        return [p for p in self.parts(proxy) if p.tag.endswith("Property")]

    def test_filters(self):
        self.assertGreaterEqual(len(self.filters), 3)
        for proxy in self.filters:
            name = proxy.get("name")
            menu = proxy.find("Hints/ShowInMenu")
            self.assertEqual(menu.get("category"), "Multi-Label", name)
            self.assertEqual(proxy.get("class"), "vtk" + name)
            # paraview.simple makes a function's name from the label.
            self.assertEqual(re.sub(r"\W", "", proxy.get("label")), name)
            self.assertTrue(proxy.find("Documentation").text.strip(), name)
            self.assertTrue(proxy.find("Documentation").get("short_help"), name)
            for port in proxy.findall("OutputPort"):
                self.assertTrue(port.get("name"), name)
            self.assertTrue(proxy.findall("OutputPort"), name)

    def test_properties(self):
        for proxy in self.filters:
            for item in self.properties(proxy):
                name = f"{proxy.get('name')}.{item.get('name')}"
                if item.get("information_only"):
                    continue
                help_text = item.find("Documentation")
                self.assertIsNotNone(help_text, name)
                self.assertGreater(len(help_text.text.split()), 2, name)
                if item.tag != "InputProperty":
                    self.assertEqual(item.get("label"), spaced(item.get("name")), name)

    def test_every_option_of_the_classes_is_there(self):
        for proxy in self.filters:
            commands = {p.get("command") for p in self.properties(proxy)}
            for name in setters(proxy.get("class")):
                self.assertIn("Set" + name, commands, proxy.get("name"))

    def test_groups_and_decorators_name_properties(self):
        for proxy in self.filters:
            names = {p.get("name") for p in self.properties(proxy)}
            for part in self.parts(proxy):
                if part.tag == "PropertyGroup":
                    for item in part.findall("Property"):
                        self.assertIn(item.get("name"), names, proxy.get("name"))
                for decorator in part.iter("PropertyWidgetDecorator"):
                    self.assertIn(decorator.get("property"), names, proxy.get("name"))


if __name__ == "__main__":
    unittest.main()

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


def own_text(name):
    return (ROOT / "Filters" / f"{name}.h").read_text(encoding="utf-8")


def setters(name):
    """Names X of the members SetX of a class and of its own superclass, from the headers."""
    text = own_text(name)
    names = set(re.findall(r"vtkSet(?:Clamp)?Macro\((\w+),", text))
    if "public vtkMultiLabelImageAlgorithm" in text:
        names |= setters("vtkMultiLabelImageAlgorithm")
    return names - NOT_OPTIONS


def lists(name):
    """Names X of the members RemoveAllX, which clear a list that grows by AddX or SetX."""
    return set(re.findall(r"void RemoveAll(\w+)\(\);", own_text(name)))


def defaults(name):
    """{property: first value} of the class's numbers and enumerators that the header names."""
    members = re.findall(r"^  (?:int|double|bool|vtkIdType) (\w+) = ([\w.]+);", own_text(name), re.M)
    # ParaView colours by the active scalars, which need one component.
    return {member: value for member, value in members if member != "ActiveScalars"}


def value_of(text, item):
    """The number of a default in a header: of true and false, and of an enumerator."""
    numbers = {"false": 0.0, "true": 1.0, "SINGLE_PRECISION": 0.0, "DOUBLE_PRECISION": 1.0}
    numbers.update((e.get("text").replace(" ", ""), float(e.get("value"))) for e in item.iter("Entry"))
    return numbers[text] if text in numbers else float(text)


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
        names = {path.stem for path in (ROOT / "Filters").glob("vtkMultiLabel*.h")}
        made = {name for name in names if f"static {name}* New();" in own_text(name)}
        self.assertEqual({p.get("class") for p in self.filters}, made)
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

    def test_every_list_of_the_classes_is_there(self):
        for proxy in self.filters:
            cleaned = {p.get("clean_command"): p for p in self.properties(proxy)}
            for name in lists(proxy.get("class")):
                item = cleaned.get("RemoveAll" + name)
                self.assertIsNotNone(item, f"{proxy.get('name')}: no list {name}")
                self.assertEqual(item.get("name"), name)
                self.assertIn(item.get("command"), {"Add" + name[:-1], "Set" + name[:-1]})
                self.assertEqual(item.get("repeat_command"), "1")
                self.assertIsNone(item.get("default_values"))

    def test_defaults_are_those_of_the_classes(self):
        checked = 0
        for proxy in self.filters:
            items = {p.get("name"): p for p in self.properties(proxy)}
            for name, text in defaults(proxy.get("class")).items():
                item = items[name]
                value = float(item.get("default_values"))
                self.assertEqual(value, value_of(text, item), f"{proxy.get('name')}.{name}")
                checked += 1
        self.assertGreater(checked, 20)

    def test_options_without_effect_do_not_show(self):
        """What a decorator hides, and by which value of which option."""
        shown = {
            ("MultiLabelIndicators", "DistanceBand"): ("Method", "0", None),
            ("MultiLabelIndicators", "PreserveVolume"): ("Method", "0", None),
            ("MultiLabelIndicators", "GaussianSigma"): ("GaussianSmoothing", "1", None),
            ("MultiLabelIndicators", "CurvatureDiffusionTimeStep"): (
                "CurvatureDiffusionIterations",
                "0",
                "1",
            ),
            ("MultiLabelInterfaceMesher", "CellSize"): ("VolumeMesh", "1", None),
            ("MultiLabelInterfaceMesher", "LabelCellSizes"): ("VolumeMesh", "1", None),
        }
        proxies = {p.get("name"): p for p in self.filters}
        for (filter_name, name), wanted in shown.items():
            (item,) = [p for p in self.properties(proxies[filter_name]) if p.get("name") == name]
            decorator = item.find("Hints/PropertyWidgetDecorator")
            found = tuple(decorator.get(key) for key in ("property", "value", "inverse"))
            self.assertEqual(found, wanted, name)
            self.assertEqual(decorator.get("mode"), "visibility", name)

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

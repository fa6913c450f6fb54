"""A job template of Open Job Description, version 2023-09: read, checked, and run on this machine.

Of the specification (the page "Template Schemas" of its wiki) that is checked which our template uses; a key that is
not known here is an error, so that whoever adds one adds its rule. Extensions are not known.
"""

import re
import subprocess

import yaml

IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}\Z")
REFERENCE = re.compile(r"\{\{\s*(.*?)\s*\}\}")


class TemplateError(Exception):
    """What in a template is against the specification, and where."""


def require(condition, where, what):
    if not condition:
        raise TemplateError(f"{where}: {what}")


def keys(value, where, required, optional=()):
    require(isinstance(value, dict), where, "is no object")
    for key in required:
        require(key in value, where, f"lacks {key}")
    for key in value:
        require(key in required or key in optional, where, f"has an unknown key {key}")


def items(value, where, most=None):
    require(isinstance(value, list) and value, where, "is no list with elements")
    require(most is None or len(value) <= most, where, f"has more than {most} elements")
    return [(one, f"{where}[{index}]") for index, one in enumerate(value)]


def text(value, where, most=None, lines=False):
    require(isinstance(value, str) and value, where, "is no text")
    require(most is None or len(value) <= most, where, f"has more than {most} characters")
    allowed = "\n\r\t" if lines else ""
    require(all(sign.isprintable() or sign in allowed for sign in value), where, "has a control character")
    return value


def references(value, where, known):
    """The names in a format string are all known in its scope."""
    require(isinstance(value, str), where, "is no text")
    for name in REFERENCE.findall(value):
        require(name in known, where, f"{name} is not known here; known are {', '.join(sorted(known))}")
    require("{{" not in REFERENCE.sub("", value), where, "has braces that do not close")


def job_parameter(value, where):
    kinds = {
        "STRING": ("minLength", "maxLength"),
        "PATH": ("minLength", "maxLength", "objectType", "dataFlow"),
        "INT": ("minValue", "maxValue"),
        "FLOAT": ("minValue", "maxValue"),
    }
    kind = value.get("type") if isinstance(value, dict) else None
    require(kind in kinds, where, f"{kind} is no type")
    keys(value, where, ("name", "type"), ("description", "default", "allowedValues", *kinds[kind]))
    require(IDENTIFIER.match(str(value["name"])), where, f"{value['name']} is no identifier")
    if "description" in value:
        text(value["description"], f"{where}.description", 2048, lines=True)
    if "default" in value:
        wanted = {"INT": int, "FLOAT": (int, float)}.get(kind, str)
        require(isinstance(value["default"], wanted), where, "has a default of another type")
        require(kind not in ("INT", "FLOAT") or value.get("minValue", value["default"]) <= value["default"]
                <= value.get("maxValue", value["default"]), where, "has a default outside its range")
    require(value.get("objectType", "FILE") in ("FILE", "DIRECTORY"), where, "has no such objectType")
    require(value.get("dataFlow", "IN") in ("NONE", "IN", "OUT", "INOUT"), where, "has no such dataFlow")
    return value["name"], kind


def action(value, where, known):
    keys(value, where, ("command",), ("args", "timeout", "cancelation"))
    references(text(value["command"], f"{where}.command"), f"{where}.command", known)
    for one, place in items(value["args"], f"{where}.args") if "args" in value else ():
        references(one, place, known)
    if "timeout" in value:
        require(isinstance(value["timeout"], int) and value["timeout"] > 0, where, "has no sound timeout")
    if "cancelation" in value:
        keys(value["cancelation"], f"{where}.cancelation", ("mode",), ("notifyPeriodInSeconds",))
        mode = value["cancelation"]["mode"]
        require(mode in ("TERMINATE", "NOTIFY_THEN_TERMINATE"), where, f"{mode} is no way to cancel")
        period = value["cancelation"].get("notifyPeriodInSeconds", 1)
        require(isinstance(period, int) and 0 < period <= 600, where, "notifies for no sound time")


def parameter_space(value, where, parameters):
    """The names of a step's task parameters."""
    keys(value, where, ("taskParameterDefinitions",), ("combination",))
    names = set()
    for one, place in items(value["taskParameterDefinitions"], f"{where}.taskParameterDefinitions", 16):
        keys(one, place, ("name", "type", "range"))
        require(IDENTIFIER.match(str(one["name"])) and one["name"] not in names, place, "has no name of its own")
        require(one["type"] == "INT" and isinstance(one["range"], str), place, "only ranges of INT are known here")
        references(one["range"], f"{place}.range", parameters)
        number = r"\s*-?(?:\d+|\{\{[^}]*\}\})\s*"
        require(re.fullmatch(rf"{number}(?:-{number}(?::{number})?)?", one["range"]), place, "is no range")
        names.add(one["name"])
    return {f"Task.{kind}.{name}" for name in names for kind in ("Param", "RawParam")}


def host_requirements(value, where):
    keys(value, where, ("amounts",))
    for one, place in items(value["amounts"], f"{where}.amounts", 50):
        keys(one, place, ("name",), ("min", "max"))
        require(re.fullmatch(r"amount(\.[A-Za-z_][A-Za-z0-9_]*)+", str(one["name"])), place, "has no name of an amount")
        require("min" in one or "max" in one, place, "has neither min nor max")


def check(template):
    """Raises TemplateError for what is against the specification."""
    keys(template, "the template", ("specificationVersion", "name", "steps"), ("description", "parameterDefinitions"))
    require(template["specificationVersion"] == "jobtemplate-2023-09", "specificationVersion", "is another")
    parameters = {}
    if "parameterDefinitions" in template:
        for one, place in items(template["parameterDefinitions"], "parameterDefinitions", 50):
            name, kind = job_parameter(one, place)
            require(name not in parameters, place, f"there is a second {name}")
            parameters[name] = kind
    # Paths are known as they were given everywhere, and as they are on a worker only in what runs there.
    early = {f"RawParam.{name}" for name in parameters}
    early |= {f"Param.{name}" for name, kind in parameters.items() if kind != "PATH"}
    on_worker = early | {f"Param.{name}" for name in parameters} | {"Session.WorkingDirectory"}
    references(text(template["name"], "name", 128), "name", early)
    if "description" in template:
        text(template["description"], "description", 2048, lines=True)

    names = [step.get("name") for step in template["steps"] if isinstance(step, dict)]
    for step, place in items(template["steps"], "steps"):
        keys(step, place, ("name", "script"), ("description", "dependencies", "hostRequirements", "parameterSpace"))
        require(names.count(text(step["name"], f"{place}.name", 64)) == 1, place, "has the name of another step")
        for one, where in items(step["dependencies"], f"{place}.dependencies") if "dependencies" in step else ():
            keys(one, where, ("dependsOn",))
            require(one["dependsOn"] in names and one["dependsOn"] != step["name"], where, "is on no other step")
        if "hostRequirements" in step:
            host_requirements(step["hostRequirements"], f"{place}.hostRequirements")
        known = set(on_worker)
        if "parameterSpace" in step:
            known |= parameter_space(step["parameterSpace"], f"{place}.parameterSpace", early)
        keys(step["script"], f"{place}.script", ("actions",))
        keys(step["script"]["actions"], f"{place}.script.actions", ("onRun",))
        action(step["script"]["actions"]["onRun"], f"{place}.script.actions.onRun", known)


def load(path):
    with open(path, encoding="utf-8") as file:
        return yaml.safe_load(file)


def commands(template, values):
    """What a manager would run for these values of the parameters, in an order that keeps dependencies."""
    given = {one["name"]: values.get(one["name"], one.get("default")) for one in template.get("parameterDefinitions", [])}
    missing = [name for name, value in given.items() if value is None]
    require(not missing, "the job", f"no value for {', '.join(missing)}")
    scope = {f"{kind}.{name}": str(value) for name, value in given.items() for kind in ("Param", "RawParam")}

    def resolve(value, more):
        return REFERENCE.sub(lambda match: {**scope, **more}[match.group(1)], value)

    done = set()
    waiting = list(template["steps"])
    while waiting:
        step = next((one for one in waiting if all(need["dependsOn"] in done for need in one.get("dependencies", []))), None)
        require(step is not None, "steps", "wait for each other")
        waiting.remove(step)
        done.add(step["name"])
        tasks = [{}]
        for one in step.get("parameterSpace", {}).get("taskParameterDefinitions", []):
            first, last = (int(bound) for bound in resolve(one["range"], {}).split("-"))
            tasks = [{**task, f"Task.Param.{one['name']}": str(number)}
                     for task in tasks for number in range(first, last + 1)]
        run = step["script"]["actions"]["onRun"]
        for task in tasks:
            yield [resolve(word, task) for word in (run["command"], *run.get("args", []))]


def run(template, values):
    for command in commands(template, values):
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

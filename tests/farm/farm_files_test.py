"""The files that give a batch to a farm's manager (Slurm, OpenCue, Open Job Description), without a manager.

python3 tests/farm/farm_files_test.py; exits with 77, which ctest takes for skipped, where there is no PyYAML.
"""

import copy
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import openjd
except ImportError as error:
    print(f"skipped: {error} (Debian: python3-yaml)")
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
TEMPLATE = ROOT / "packaging/openjd/welkin-batch.yaml"

# A welkin that notes its words.
NOTES_WORDS = """#!/usr/bin/env python3
import json, os, sys
with open(os.environ["WORDS"], "a") as file:
    file.write(json.dumps(sys.argv[1:]) + "\\n")
"""


class Folder(unittest.TestCase):
    """In a folder whose name has what shells and Slurm take for signs of theirs."""

    def setUp(self):
        parent = tempfile.TemporaryDirectory()
        self.addCleanup(parent.cleanup)
        self.folder = pathlib.Path(parent.name) / "it's 100% \"a\" $b;c"
        self.folder.mkdir()
        self.plan = self.folder / "my jobs.json"
        self.write_plan(jobs=2000, seconds=300000.5)
        self.welkin = self.folder / "wel kin"
        self.welkin.write_text(NOTES_WORDS)
        self.welkin.chmod(0o755)
        self.words = self.folder / "words"
        self.environment = {**os.environ, "WORDS": str(self.words), "WELKIN": str(self.welkin)}

    def write_plan(self, jobs, seconds):
        self.plan.write_text(json.dumps({"version": 1, "totals": {"jobs": jobs, "seconds": seconds}, "jobs": []}))

    def run_words(self, command, **environment):
        """Runs a command, and says what welkin was called with."""
        self.words.write_text("")
        subprocess.run(command, check=True, env={**self.environment, **environment}, stdout=subprocess.DEVNULL)
        return [json.loads(line) for line in self.words.read_text().splitlines()]


class OpenJobDescription(Folder):
    def setUp(self):
        super().setUp()
        self.template = openjd.load(TEMPLATE)

    def test_our_template_is_as_specified(self):
        openjd.check(self.template)

    def test_a_manager_would_run_every_shard_and_then_the_merge(self):
        self.words.write_text("")
        os.environ["WORDS"] = str(self.words)
        openjd.run(self.template, {"Plan": str(self.plan), "Results": "r s", "Merged": "m", "Shards": 3, "Threads": 2,
                                   "Welkin": str(self.welkin)})
        run = ["batch", "run", str(self.plan), "--results", "r s", "--threads", "2", "--shard"]
        self.assertEqual([json.loads(line) for line in self.words.read_text().splitlines()],
                         [[*run, "1/3"], [*run, "2/3"], [*run, "3/3"],
                          ["batch", "merge", str(self.plan), "--results", "r s", "-o", "m"]])

    def test_what_is_against_the_specification_is_found(self):
        def on_run(template, step=0):
            return template["steps"][step]["script"]["actions"]["onRun"]

        def set_to(path, value):
            def change(template):
                target = template
                for key in path[:-1]:
                    target = target[key]
                if value is None:
                    del target[path[-1]]
                else:
                    target[path[-1]] = value
            return change

        definitions = ("steps", 0, "parameterSpace", "taskParameterDefinitions", 0)
        mutations = {
            "is another": set_to(("specificationVersion",), "jobtemplate-2022"),
            "lacks name": set_to(("name",), None),
            "lacks steps": set_to(("steps",), None),
            "Param.Plan is not known here": set_to(("name",), "{{Param.Plan}}"),
            "Task.Param.Shard is not known": lambda one: on_run(one, 1)["args"].append("{{Task.Param.Shard}}"),
            "Param.Shard is not known": lambda one: on_run(one)["args"].append("{{Param.Shard}}"),
            "braces that do not close": lambda one: on_run(one)["args"].append("{{Param.Shards}"),
            "is no text": lambda one: on_run(one)["args"].append(7),
            "lacks command": lambda one: on_run(one).pop("command"),
            "unknown key cancellation": lambda one: on_run(one).update(cancellation={"mode": "TERMINATE"}),
            "is no way to cancel": lambda one: on_run(one)["cancelation"].update(mode="KILL"),
            "no sound timeout": lambda one: on_run(one).update(timeout="10"),
            "is on no other step": set_to(("steps", 1, "dependencies", 0, "dependsOn"), "Shard"),
            "name of another step": set_to(("steps", 1, "name"), "Shards"),
            "is no range": set_to((*definitions, "range"), "1..{{Param.Shards}}"),
            "only ranges of INT": set_to((*definitions, "type"), "FLOAT"),
            "no name of an amount": set_to(("steps", 0, "hostRequirements", "amounts", 0, "name"), "vcpu"),
            "is no type": set_to(("parameterDefinitions", 0, "type"), "TEXT"),
            "is no identifier": set_to(("parameterDefinitions", 0, "name"), "9lives"),
            "there is a second Plan": set_to(("parameterDefinitions", 0, "name"), "Plan"),
            "default outside its range": set_to(("parameterDefinitions", 4, "default"), 0),
            "default of another type": set_to(("parameterDefinitions", 4, "default"), "100"),
            "no such dataFlow": set_to(("parameterDefinitions", 1, "dataFlow"), "READ"),
        }
        for message, mutate in mutations.items():
            with self.subTest(message):
                template = copy.deepcopy(self.template)
                mutate(template)
                with self.assertRaisesRegex(openjd.TemplateError, message):
                    openjd.check(template)


class OpenCue(Folder):
    script = ROOT / "packaging/opencue/batch-commands"

    def test_each_line_is_a_shard_to_sh(self):
        lines = subprocess.run([self.script, self.plan.name, "2", "--results", "r's $x"], check=True, text=True,
                               env=self.environment, cwd=self.folder, stdout=subprocess.PIPE).stdout.splitlines()
        self.assertEqual([self.run_words(["sh", "-c", line])[0] for line in lines],
                         [["batch", "run", str(self.plan), "--results", str(self.folder.resolve() / "r's $x"), "--shard",
                           f"{shard}/2"] for shard in (1, 2)])

    def test_paths_become_absolute(self):
        (self.folder / "-p.json").write_text("{}")
        here = str(self.folder.resolve())
        for options, meant in ((["--results", "../r"], ["--results", str(self.folder.resolve().parent / "r")]),
                               (["--results=r", "-q"], [f"--results={here}/r", "-q"]),
                               (["--results", "-r"], ["--results", f"{here}/-r"]),
                               (["--results", "/r"], ["--results", "/r"]), ([], [])):
            with self.subTest(options=options):
                line = subprocess.run([self.script, "-p.json", "1", *options], check=True, text=True,
                                      env=self.environment, cwd=self.folder, stdout=subprocess.PIPE).stdout
                self.assertEqual(self.run_words(["sh", "-c", line]),
                                 [["batch", "run", f"{here}/-p.json", *meant, "--shard", "1/1"]])

    def test_what_cannot_be_is_refused(self):
        for arguments, message in ((["absent.json", "2"], "there is no file"), ([str(self.plan), "0"], "whole number"),
                                   ([str(self.plan)], "usage"), ([str(self.plan), "1", "a\nb"], "line break"),
                                   ([str(self.plan), "1", "--results"], "takes a folder")):
            with self.subTest(message):
                refused = subprocess.run([self.script, *arguments], text=True, capture_output=True, env=self.environment)
                self.assertEqual(refused.returncode, 2)
                self.assertIn(message, refused.stderr)


class Slurm(Folder):
    script = ROOT / "scripts/batch-slurm"

    def dry_run(self, *options):
        return subprocess.run([self.script, self.plan, "--dry-run", "--welkin", self.welkin, *options], text=True,
                              capture_output=True, env=self.environment)

    def job(self, name, **environment):
        return self.run_words(["bash", self.folder / "my jobs.results/slurm" / f"{name}.sh"], **environment)

    def test_job_scripts_call_welkin_with_the_words_meant(self):
        done = self.dry_run("--shards", "100", "--verify", "0.01", "--memory", "4GiB", "--cpus", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        results = str(self.folder / "my jobs.results")
        run = ["batch", "run", str(self.plan), "--results", results, "--threads", "2", "--memory", "3072MiB"]
        self.assertEqual(self.job("shards", SLURM_ARRAY_TASK_ID="7"), [[*run, "--shard", "7/100"]])
        self.assertEqual(self.job("verify", SLURM_ARRAY_TASK_ID="2"), [[*run, "--verify", "0.01", "--shard", "2/2"]])
        self.assertEqual(self.job("merge"), [["batch", "merge", str(self.plan), "--results", results, "-o",
                                              str(self.folder / "my jobs.merged")]])
        script = (self.folder / "my jobs.results/slurm/shards.sh").read_text()
        self.assertIn("\n#SBATCH --requeue\n", script)
        self.assertIn("\n#SBATCH --mem=4096M\n", script)
        self.assertIn("100%%", script)

    def test_a_plan_may_take_longer_than_32_bits_have_seconds(self):
        self.write_plan(10, 1e12)
        for options in ((), ("--shards", "2", "--cpus", "3")):
            done = self.dry_run(*options)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("10 jobs, 1000000000000 seconds", done.stderr)

    def test_a_backslash_in_a_log_path_is_itself(self):
        self.assertEqual(self.dry_run("--results", str(self.folder / "a\\b")).returncode, 0)
        script = (self.folder / "a\\b/slurm/shards.sh").read_text()
        self.assertIn("a\\\\b/slurm/shard-%a.log", script)

    def test_a_task_may_have_more_threads_than_cores(self):
        self.assertEqual(self.dry_run("--cpus", "2", "--threads", "16").returncode, 0)
        (words,) = self.job("shards", SLURM_ARRAY_TASK_ID="1")
        self.assertEqual(words[words.index("--threads") + 1], "16")
        self.assertIn("\n#SBATCH --cpus-per-task=2\n", (self.folder / "my jobs.results/slurm/shards.sh").read_text())

    def test_jobs_wait_for_each_other(self):
        lines = self.dry_run("--verify", "0.5", "--at-once", "8").stdout.splitlines()
        self.assertEqual(len(lines), 3)
        self.assertIn("--array=1-251%8", lines[0].replace("\\", ""))
        self.assertIn("--dependency=afterok:JOB-OF-shards --kill-on-invalid-dep=yes --array=1-126", lines[1])
        self.assertIn("--dependency=afterok:JOB-OF-verify", lines[2])
        self.assertIn("--dependency=afterany:JOB-OF-shards", self.dry_run("--merge-always").stdout)

    def test_shards_are_made_to_last_as_long_as_asked(self):
        for plan, options, shards in (((2000, 300000.5), (), 251), ((2000, 300000.5), ("--minutes", "60"), 84),
                                      ((2000, 300000.5), ("--cpus", "4"), 63), ((3, 300000.5), (), 3), ((9, 0.5), (), 1)):
            self.write_plan(*plan)
            with self.subTest(plan=plan, options=options):
                done = self.dry_run(*options)
                self.assertIn(f"--array=1-{shards} ", done.stdout)
                self.assertIn(f": {shards} shards of about", done.stderr)
        self.write_plan(5000, 1e7)
        many = self.dry_run()
        self.assertIn("MaxArraySize", many.stderr)
        self.assertIn("--array=1-1000 ", many.stdout)

    def test_shards_too_small_or_too_large_are_warned_of(self):
        self.assertIn("shards are small", self.dry_run("--shards", "100", "--cpus", "64").stderr)
        self.assertIn("shards are large", self.dry_run("--shards", "4").stderr)
        self.assertNotIn("warning", self.dry_run("--shards", "251").stderr)
        self.write_plan(2, 100000)
        self.assertIn("fewer jobs than shards", self.dry_run("--shards", "40").stderr)

    def test_what_cannot_be_is_refused(self):
        for options, message in ((("--shards", "0"), "whole number"), (("--shards",), "takes a value"),
                                 (("--verify", "2"), "takes a share"), (("--memory", "much"), "takes a size"),
                                 (("--shard", "4"), "no option --shard"), (("other.json",), "one plan at a time"),
                                 (("--results", "a\nb"), "line breaks"), (("--shards", "5000"), "MaxArraySize"),
                                 (("--partition", "a\ntouch X"), "--partition takes no value with line breaks")):
            with self.subTest(message):
                refused = self.dry_run(*options)
                self.assertNotEqual(refused.returncode, 0)
                self.assertIn(message, refused.stderr)
        deep = "[" * 100000 + "]" * 100000
        seconds = [f'{{"totals": {{"jobs": 2, "seconds": {value}}}}}' for value in ("NaN", "1e400", "-1", "1e13", '"x"')]
        jobs = [f'{{"totals": {{"jobs": {value}, "seconds": 1}}}}' for value in ("1e400", "-1", "NaN", "1" + "0" * 30)]
        for plan in ("{}", "[]", "", deep, *seconds, *jobs):
            with self.subTest(plan=plan[:50]):
                self.plan.write_text(plan)
                refused = self.dry_run()
                self.assertEqual(refused.returncode, 1)
                self.assertIn("is not a plan", refused.stderr)
                self.assertEqual(len(refused.stderr.splitlines()), 1)
        self.plan.unlink()
        self.assertIn("there is no file", self.dry_run().stderr)

    def test_without_slurm_it_says_what_is_missing(self):
        # A path with all commands but Slurm's.
        tools = self.folder / "tools"
        tools.mkdir()
        for folder in ("/usr/bin", "/bin"):
            for name in ("bash", "env", "dirname", "readlink", "realpath", "python3"):
                if os.path.exists(f"{folder}/{name}") and not (tools / name).exists():
                    (tools / name).symlink_to(f"{folder}/{name}")
        refused = subprocess.run([self.script, self.plan], text=True, capture_output=True, env={"PATH": str(tools)})
        self.assertEqual(refused.returncode, 1)
        self.assertIn("there is no sbatch here", refused.stderr)


if __name__ == "__main__":
    unittest.main()

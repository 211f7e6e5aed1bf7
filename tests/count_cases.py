"""Counts test cases: count_cases.py JUNIT REPORTS

JUNIT is what ctest wrote, a test a program, shard or script; REPORTS is the folder where each shard of a GoogleTest program left its
own report of cases. A shard that failed without a failed case (it crashed, or leaked) counts as one. Tells on standard error what
failed, with what it printed, and what was skipped and why; on standard output "PASSED FAILED SKIPPED".
"""
import collections
import pathlib
import re
import sys
import xml.etree.ElementTree as xml


def cases_of(report):
    """(name, verdict, why) of each case of a GoogleTest report."""
    for case in xml.parse(report).iter("testcase"):
        name = case.get("classname") + "." + case.get("name")
        if case.find("failure") is not None:
            yield name, "failed", ""
        elif case.get("result") == "skipped":
            yield name, "skipped", case.find("skipped").get("message", "").split("\n", 1)[-1].strip()
        elif case.get("status") == "run":
            yield name, "passed", ""


def without_passed(output):
    """GoogleTest's lines without those of the cases that passed; a case that never ended keeps its RUN line."""
    return re.sub(r"^\[ RUN      \].*\n\[       OK \].*\n", "", output, flags=re.M)


def count(junit, reports):
    """[(name, verdict, why)] of all cases, and what the failed tests printed."""
    cases, printed = [], []
    for test in xml.parse(junit).iter("testcase"):
        name, status = test.get("name"), test.get("status")
        report = reports / f"{name}.xml"
        own = [(f"{name}: {case}", *rest) for case, *rest in cases_of(report)] if report.exists() else []
        cases += own
        bad = status == "fail" or (status != "run" and test.find("skipped") is None)
        if bad and not any(verdict == "failed" for _, verdict, _ in own):
            cases.append((name, "failed", ""))
        elif not report.exists():
            cases.append((name, "passed" if status == "run" else "skipped", ""))
        if bad:
            printed.append(f"---- {name} printed:\n" + without_passed(test.findtext("system-out", "")))
    return cases, printed


def self_test():
    """A shard whose report tells of a failure, one that crashed, one that leaked at its end, and two scripts."""
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        case = '<testcase classname="S" name="{}" status="run" result="{}">{}</testcase>'
        folder.joinpath("a.xml").write_text("<testsuites>" + case.format("one", "completed", "") +
                                            case.format("two", "completed", '<failure message="no"/>') +
                                            case.format("three", "skipped", '<skipped message="f.cpp:3&#x0A;no levels"/>') + "</testsuites>")
        folder.joinpath("leak.xml").write_text("<testsuites>" + case.format("four", "completed", "") + "</testsuites>")
        test = '<testcase name="{}" status="{}"><system-out>[ RUN      ] S.x\n[       OK ] S.x\n[ RUN      ] S.y\n</system-out></testcase>'
        folder.joinpath("junit").write_text("<testsuite>" + test.format("a", "fail") + test.format("crash", "fail") + test.format("leak", "fail") +
                                            test.format("script", "run") + test.format("other", "fail") + "</testsuite>")
        cases, printed = count(folder / "junit", folder)
    assert [(n, v) for n, v, _ in cases] == [
        ("a: S.one", "passed"), ("a: S.two", "failed"), ("a: S.three", "skipped"), ("crash", "failed"), ("leak: S.four", "passed"),
        ("leak", "failed"), ("script", "passed"), ("other", "failed")], cases
    assert cases[2][2] == "no levels" and printed[1] == "---- crash printed:\n[ RUN      ] S.y\n", (cases, printed)


def main():
    self_test()
    cases, printed = count(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
    print(*printed, *(f"FAILED {name}" for name, verdict, _ in cases if verdict == "failed"),
          *(f"skipped {name}: {why or 'it says not why'}" for name, verdict, why in cases if verdict == "skipped"), sep="\n", file=sys.stderr)
    counts = collections.Counter(verdict for _, verdict, _ in cases)
    print(counts["passed"], counts["failed"], counts["skipped"])


main()

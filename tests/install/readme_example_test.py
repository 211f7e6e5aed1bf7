"""Installs the build into an empty folder, builds the README's example as a project of its own against it, and runs it on a
file that the installed program wrote: arguments are the source tree, the build tree and cmake."""
import pathlib
import re
import subprocess
import sys
import tempfile

source, build, cmake = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def block(language):
    found = re.findall(rf"^```{language}\n(.*?)^```$", (source / "README.md").read_text(), re.M | re.S)
    assert len(found) == 1, f"{len(found)} blocks of {language} in README.md; need one"
    return found[0]


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    run(cmake, "--install", build, "--prefix", folder / "installed")
    (folder / "engine.cpp").write_text(block("cpp"))
    headers = [file.relative_to(folder / "installed/include/vismat") for file in (folder / "installed/include").rglob("*.h")]
    assert len(headers) > 5
    (folder / "headers.cpp").write_text("".join(f'#include "{header}"\n' for header in sorted(headers)))
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.23)\nproject(engine CXX)\n"  # the compiler's default standard
        "add_executable(engine engine.cpp headers.cpp)\ntarget_compile_options(engine PRIVATE -Wall -Wextra -Werror)\n" + block("cmake") +
        "add_library(plugin SHARED plugin.cpp)\ntarget_link_libraries(plugin PRIVATE vismat::codecs)\n")
    (folder / "plugin.cpp").write_text(
        '#include "codecs/vmat/row_reader.h"\n\n'
        'extern "C" unsigned rows_of(const char* path) { return vismat::RowReader(path).shape().rows; }\n')
    run(cmake, "-G", "Ninja", "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={folder / 'installed'}")
    run(cmake, "--build", folder / "build")

    (folder / "tiny.mtx").write_text(
        "%%MatrixMarket matrix coordinate pattern general\n3 40 5\n1 1\n3 4\n3 5\n3 6\n3 40\n")
    run(folder / "installed/bin/vismat", "tree", folder / "tiny.mtx", "--side", "rows", "--by", "sets", "-o", folder / "tiny.bsp.h5")
    for codec in ("bitmap", "panne", "gotsman3-context"):
        run(folder / "installed/bin/vismat", "encode", folder / "tiny.bsp.h5", "--codec", codec, "-o", folder / "tiny.vmat")
        said = run(folder / "build/engine", folder / "tiny.vmat", "2")
        assert said == "objects seen from view cell 2: 3 4 5 39\nin 2 ranges\n", said
    refused = subprocess.run([folder / "build/engine", folder / "tiny.vmat", "3"], capture_output=True, text=True)
    assert refused.returncode == 1 and "row 3 of 3" in refused.stderr, refused.stderr

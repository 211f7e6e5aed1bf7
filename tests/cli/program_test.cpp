// The program as a whole: its help, its refusals, and what Ctrl-C leaves.
#include <fstream>
#include <limits>
#include <set>
#include <sstream>
#include <vector>

#include "matrix/base/random.h"
#include "tests/cli/program_fixture.h"
#include "tests/sanitized.h"

namespace vismat {
namespace {

std::vector<std::string> verbs_of(const std::string& help) {
  std::istringstream lines(help);
  std::vector<std::string> names;
  std::string line;
  while (std::getline(lines, line) && line.find("Verbs:") == std::string::npos) {
  }
  while (std::getline(lines, line) && line.starts_with("  ")) {
    std::istringstream words(line);
    names.emplace_back();
    words >> names.back();
  }
  return names;
}

TEST_F(Program, HelpNamesEveryVerb) {
  const std::string help = vismat_succeeds("--help").out;
  const auto found = verbs_of(help);
  for (const char* verb :
       {"import",    "city",    "cells", "dense-city", "plant",  "generate", "scene", "see",
        "triangles", "tree",    "order", "deltas",     "encode", "decode",   "row",   "compare",
        "node",      "convert", "info",  "merge",      "verify", "path"})
    EXPECT_NE(std::find(found.begin(), found.end(), verb), found.end()) << verb;
  EXPECT_TRUE(contains(help, "Example: vismat ")) << help;
}

TEST_F(Program, EveryVerbsHelpHasAnExample) {
  for (const std::string& verb : verbs_of(vismat("--help").out)) {
    const Finished run = vismat_succeeds(verb + " --help");
    EXPECT_TRUE(contains(run.out, "Example: vismat " + verb)) << verb;
    EXPECT_EQ(run.error, "") << verb;
  }
}

TEST_F(Program, RefusesInOneLine) {
  write("text.bsp.h5", "this is no matrix");
  std::vector<std::string> wrong = {"",
                                    "no-such-verb",
                                    "--no-such-option",
                                    "city --size many -o result.scene.h5",
                                    "city --size 4 -o no/folder.scene.h5",
                                    "cells missing.bsp.h5 --cells grid:4m -o result.scene.h5"};
  for (const std::string& verb : verbs_of(vismat("--help").out)) {
    wrong.insert(wrong.end(), {verb + " missing.bsp.h5 -o result.mtx", verb + " text.bsp.h5",
                               verb + " text.bsp.h5 -o result.mtx"});
    if (!test::sanitized) wrong.insert(wrong.end(), {verb + " --no-such-option", verb + " missing.bsp.h5"});
  }
  for (const std::string& words : wrong) expect_refusal(words, "");
  expect_refusal("no-such-verb", "there is no verb 'no-such-verb'; 'vismat --help' lists them");
  expect_refusal("", "name a verb");
  expect_refusal("encode text.bsp.h5 -o x.vmat --seconds -1", "--seconds: Value -1 below 0");
  expect_refusal("merge text.bsp.h5 -o x.bsp.h5 --lost 2", "--lost: Value 2 not in range 0 to 1");
}

/// Ctrl-C falls right after some of the changes to files, among them the first and the last: whatever the program was doing then,
/// what stands under the final name is whole, either the old file or the new one, and nothing lies beside it. Changes are counted, not
/// microseconds, so that the moments are the same on any machine, however busy it is.
class Interrupted : public Program {
 protected:
  void everywhere(const std::string& words, const std::string& result) const {
    const Finished undisturbed = vismat(words, std::numeric_limits<unsigned>::max());
    ASSERT_EQ(undisturbed.code, 0) << undisturbed.error;
    const unsigned all = undisturbed.changes;
    ASSERT_GE(all, 6u) << "a partial file made, written and named, and a line on what was written";
    const std::string whole = contents(result);
    const std::size_t files = folder.entries();
    ASSERT_FALSE(whole.empty());
    bool before = false, after = false;
    for (const unsigned changes : std::set<unsigned>{1, 2, 3, all / 2, all - 3, all - 2, all - 1, all}) {
      write(result, "old");
      EXPECT_EQ(vismat(words, changes).code, 130);
      const std::string left = contents(result);
      EXPECT_TRUE(left == whole || left == "old") << left.size() << " bytes";
      (left == whole ? after : before) = true;
      EXPECT_EQ(folder.entries(), files) << "after " << changes << " of " << all << " changes";
    }
    EXPECT_TRUE(before && after);
  }
};

TEST_F(Interrupted, LeavesNoPartialMatrix) {
  Random random(1);
  std::vector<std::vector<std::uint32_t>> rows(600);
  for (auto& row : rows) {
    for (std::uint32_t c = random.below(9); c < 3000; c += 1 + random.below(9)) row.push_back(c);
  }
  Dataset dataset;
  dataset.matrix = VisibilityMatrix::from_rows(rows, 3000);
  write("in.bsp.h5", dataset);
  everywhere("convert in.bsp.h5 -o out.bsp.h5", "out.bsp.h5");
  everywhere("convert in.bsp.h5 -o out.mtx", "out.mtx");
}

TEST_F(Interrupted, LeavesNoPartialScene) {
  everywhere("city --size 16 -o out.scene.h5", "out.scene.h5");
}

}  // namespace
}  // namespace vismat

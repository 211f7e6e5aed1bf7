#include "matrix/files/binsparse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "matrix/base/byte_reader.h"
#include "tests/matrix/temporary_folder.h"

namespace vismat {
namespace {

using nlohmann::json;

/// A file made of a descriptor and arrays, and what read_binsparse makes of it.
struct Source {
  json descriptor = {{"version", "0.1"},
                     {"format", "CSR"},
                     {"shape", {3, 4}},
                     {"number_of_stored_values", 5},
                     {"data_types", {{"values", "iso[bint8]"}}}};
  std::vector<std::uint64_t> pointers = {0, 2, 2, 5};
  std::vector<std::uint32_t> indices_0, indices_1 = {1, 3, 0, 1, 2};
  std::vector<float> values = {1};

  Dataset read(MatrixNotes* notes = nullptr) const {
    const TemporaryFolder folder;
    {
      Hdf5File file = Hdf5File::create(folder / "a.h5");
      file.write_attribute("/", "binsparse", json{{"binsparse", descriptor}}.dump());
      const auto array = [&]<typename Number>(const std::string& name, const std::vector<Number>& numbers) {
        if (!numbers.empty()) file.write<Number>(name, numbers, {numbers.size()});
      };
      array("/pointers_to_1", pointers);
      array("/indices_0", indices_0);
      array("/indices_1", indices_1);
      array("/values", values);
    }
    return read_binsparse(Hdf5File::open(folder / "a.h5"), notes);
  }
  VisibilityMatrix matrix() const { return read().matrix; }
  std::string refusal() const {
    try {
      read();
    } catch (const FormatError& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      return text;
    }
    return "";
  }
};

const auto stored = VisibilityMatrix::from_rows({{1, 3}, {}, {0, 1, 2}}, 4);

TEST(Binsparse, ReadsEveryMatrixFormat) {
  Source source;
  EXPECT_EQ(source.matrix(), stored);

  source.descriptor["format"] = "DCSR";
  source.pointers = {0, 2, 5};
  source.indices_0 = {0, 2};
  EXPECT_EQ(source.matrix(), stored);

  source.pointers = {};
  source.indices_0 = {0, 0, 2, 2, 2};
  for (const char* name : {"COO", "COOR"}) {
    source.descriptor["format"] = name;
    EXPECT_EQ(source.matrix(), stored);
  }

  source.descriptor["format"] = "COOC";
  source.indices_0 = {0, 1, 1, 2, 3};
  source.indices_1 = {2, 0, 2, 2, 0};
  EXPECT_EQ(source.matrix(), stored);

  source.descriptor["format"] = "CSC";
  source.indices_0 = {};
  source.pointers = {0, 1, 3, 4, 5};
  EXPECT_EQ(source.matrix(), stored);

  source.descriptor["format"] = "DCSC";
  source.indices_0 = {0, 1, 2, 3};
  EXPECT_EQ(source.matrix(), stored);

  source = {};
  source.descriptor["number_of_stored_values"] = 12;
  source.descriptor["data_types"]["values"] = "float32";
  source.values = {0, 1, 0, 1, 0, 0, 0, 0, 1, 1, 1, 0};
  for (const char* name : {"DMAT", "DMATR"}) {
    source.descriptor["format"] = name;
    EXPECT_EQ(source.matrix(), stored);
  }
  source.descriptor["format"] = "DMATC";
  source.values = {0, 0, 1, 1, 0, 1, 0, 0, 1, 1, 0, 0};
  EXPECT_EQ(source.matrix(), stored);
}

TEST(Binsparse, DropsEntriesWhoseValueIsZero) {
  Source source;
  source.descriptor["data_types"]["values"] = "float64";
  source.values = {0, 2, NAN, 0, -1};
  EXPECT_EQ(source.matrix(), VisibilityMatrix::from_rows({{3}, {}, {0, 2}}, 4));
  source.descriptor["data_types"]["values"] = "complex[float64]";
  source.values = {0, 1, 1, 0, 0, 0, 0, 0, 1, 1};
  EXPECT_EQ(source.matrix(), VisibilityMatrix::from_rows({{1, 3}, {}, {2}}, 4));
  source.descriptor["data_types"]["values"] = "iso[int8]";
  source.values = {0};
  EXPECT_EQ(source.matrix(), VisibilityMatrix({3, 4}));
}

TEST(Binsparse, CountsWhatItDropsAndMirrors) {
  Source source;
  MatrixNotes notes;
  source.read(&notes);
  EXPECT_EQ(notes, MatrixNotes{});
  source.descriptor["data_types"]["values"] = "float64";
  source.values = {0, 2, 3, 0, -1};
  source.read(&notes);
  EXPECT_EQ(notes, (MatrixNotes{0, 0, 2}));
  source.descriptor["shape"] = {4, 4};
  source.descriptor["structure"] = "symmetric_lower";
  source.pointers = {0, 1, 2, 4, 5};
  source.indices_1 = {0, 0, 0, 2, 1};
  source.values = {1, 1, 0, 1, 1};
  EXPECT_EQ(source.read(&notes).matrix, VisibilityMatrix::from_rows({{0, 1}, {0, 3}, {2}, {1}}, 4));
  EXPECT_EQ(notes, (MatrixNotes{0, 2, 1}));
}

TEST(Binsparse, TakesVersionsAsPeopleWriteThem) {
  Source source;
  for (const json& version :
       {json("0.1"), json("0.1.0"), json("0.5.0-rc1"), json("1.0"), json(0.1), json(1)}) {
    source.descriptor["version"] = version;
    EXPECT_EQ(source.matrix(), stored) << version;
  }
  for (const json& version :
       {json("2.0.0"), json(""), json("10.1"), json(11), json(-0.1), json(true), json::array()}) {
    source.descriptor["version"] = version;
    EXPECT_TRUE(source.refusal().find("version is " + version.dump() + "; 0.x and 1.x") != std::string::npos)
        << source.refusal();
  }
}

TEST(Binsparse, NeedsNoNumberOfStoredValues) {
  Source source;
  source.descriptor.erase("number_of_stored_values");
  EXPECT_EQ(source.matrix(), stored);
  source.descriptor["format"] = "COO";
  source.indices_0 = {0, 0, 2, 2, 2};
  EXPECT_EQ(source.matrix(), stored);
  source.descriptor["format"] = "DMATC";
  source.descriptor["data_types"]["values"] = "uint8";
  source.values = {0, 0, 1, 1, 0, 1, 0, 0, 1, 1, 0, 0};
  EXPECT_EQ(source.matrix(), stored);
  source.descriptor["shape"] = {1u << 20, 1u << 20};
  EXPECT_NE(source.refusal().find("/values: has 12 entries, but the shape calls for 1099511627776"),
            std::string::npos);
  source.descriptor["data_types"]["values"] = "iso[uint8]";
  source.values = {1};
  EXPECT_NE(source.refusal().find("visible entries by a single value"), std::string::npos)
      << source.refusal();
}

TEST(Binsparse, ExpandsOneTriangle) {
  Source source;
  source.descriptor["shape"] = {4, 4};
  source.descriptor["structure"] = "symmetric_lower";
  source.pointers = {0, 1, 2, 4, 5};
  source.indices_1 = {0, 0, 0, 2, 1};
  const auto whole = VisibilityMatrix::from_rows({{0, 1, 2}, {0, 3}, {0, 2}, {1}}, 4);
  EXPECT_EQ(source.matrix(), whole);
  source.descriptor["structure"] = "symmetric_upper";
  EXPECT_NE(source.refusal().find("other triangle"), std::string::npos);
  source.descriptor["format"] = "CSC";  // the same arrays, by columns, are the upper triangle
  EXPECT_EQ(source.matrix(), whole);
  source.descriptor["structure"] = "banded";
  EXPECT_NE(source.refusal().find("structure \"banded\""), std::string::npos);
}

TEST(Binsparse, TakesTheBareDescriptorToo) {
  const TemporaryFolder folder;
  const Source source;
  {
    Hdf5File file = Hdf5File::create(folder / "a.h5");
    file.write_attribute("/", "binsparse", source.descriptor.dump());
    file.write<std::uint64_t>("/pointers_to_1", source.pointers, {4});
    file.write<std::uint32_t>("/indices_1", source.indices_1, {5});
    file.write<float>("/values", source.values, {1});
  }
  EXPECT_EQ(read_binsparse(Hdf5File::open(folder / "a.h5")).matrix, stored);
}

// Each slip alone must be refused, in words that name the offender.
TEST(Binsparse, RefusesWhatTheSpecificationForbids) {
  const auto refused = [](const std::string& words, const std::function<void(Source&)>& slip) {
    Source source;
    slip(source);
    const std::string text = source.refusal();
    EXPECT_NE(text.find(words), std::string::npos) << "'" << text << "' does not say '" << words << "'";
  };
  refused("/indices_1: entry 4 is 4000000000, but there are 4 columns",
          [](Source& s) { s.indices_1[4] = 4000000000; });
  refused("/indices_1: entry 4 is 1 after 1 in the same row (2)", [](Source& s) { s.indices_1[4] = 1; });
  refused("/indices_1: entry 3 is 2 after 3", [](Source& s) { s.indices_1 = {1, 3, 3, 2, 3}; });
  refused("/indices_1: is missing", [](Source& s) { s.indices_1 = {}; });
  refused("/indices_1: has 4 entries", [](Source& s) { s.indices_1.pop_back(); });
  refused("/pointers_to_1: has 3 entries", [](Source& s) { s.pointers.pop_back(); });
  refused("/pointers_to_1: descends at entry 2", [](Source& s) { s.pointers = {0, 3, 2, 5}; });
  refused("/pointers_to_1: descends at entry 3", [](Source& s) { s.pointers = {0, 1, 1ull << 60, 5}; });
  refused("/pointers_to_1: ends with 6", [](Source& s) { s.pointers[3] = 6; });
  refused("/pointers_to_1: begins with 1", [](Source& s) { s.pointers[0] = 1; });
  refused("/values: has 2 entries", [](Source& s) { s.values = {1, 1}; });
  refused("/values: has 1 entries", [](Source& s) { s.descriptor["data_types"]["values"] = "uint8"; });
  refused("unknown type \"uint7\"", [](Source& s) { s.descriptor["data_types"]["values"] = "uint7"; });
  refused("no key 'data_types'", [](Source& s) { s.descriptor.erase("data_types"); });
  refused("no key 'shape'", [](Source& s) { s.descriptor.erase("shape"); });
  refused("shape must be", [](Source& s) { s.descriptor["shape"] = {3, 4, 5}; });
  refused("shape must hold non-negative", [](Source& s) { s.descriptor["shape"] = {-3, 4}; });
  refused("shape must hold non-negative", [](Source& s) { s.descriptor["shape"] = {1e30, 4}; });
  refused("has 4294967296 columns", [](Source& s) { s.descriptor["shape"] = {3, 1ull << 32}; });
  refused("claims 4294967295 columns", [](Source& s) { s.descriptor["shape"] = {3, 0xffffffffu}; });
  refused("claims 4294967295 rows", [](Source& s) { s.descriptor["shape"] = {0xffffffffu, 4}; });
  refused("is a vector", [](Source& s) { s.descriptor["format"] = "CVEC"; });
  refused("is not known", [](Source& s) { s.descriptor["format"] = "BSR\n\x01"; });
  refused("custom formats", [](Source& s) { s.descriptor["custom"] = json::object(); });
  refused("custom formats", [](Source& s) { s.descriptor["format"] = {{"level", "dense"}}; });
  refused("/fill_value: is missing", [](Source& s) { s.descriptor["fill"] = true; });
  refused("/indices_0: entry 1 is 0 after 2; they must ascend", [](Source& s) {
    s.descriptor["format"] = "DCSR";
    s.pointers = {0, 2, 5};
    s.indices_0 = {2, 0};
  });
  refused("/indices_0: entry 1 is 3, but there are only 3", [](Source& s) {
    s.descriptor["format"] = "DCSR";
    s.pointers = {0, 2, 5};
    s.indices_0 = {2, 3};
  });
  refused("/indices_0: entry 2 is 0 after 2", [](Source& s) {
    s.descriptor["format"] = "COO";
    s.indices_0 = {0, 2, 0, 2, 2};
  });
  refused("in the same row (0)", [](Source& s) {
    s.descriptor["format"] = "COO";
    s.indices_0 = {0, 0, 0, 2, 2};
    s.indices_1 = {1, 3, 3, 1, 2};
  });
}

}  // namespace
}  // namespace vismat

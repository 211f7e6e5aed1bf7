// One mesh in every dialect of every format: a table of what systems do to text, times the formats, and a table for each format
// of what programs write. All must give the same triangles.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "matrix/base/atomic_file.h"
#include "matrix/base/byte_reader.h"
#include "tests/matrix/temporary_folder.h"
#include "visibility/meshes/any_scene.h"
#include "visibility/meshes/mesh_file.h"

namespace vismat::mesh_dialects {
namespace {

using namespace std::literals;

constexpr std::array formats = {MeshFormat::obj, MeshFormat::ply, MeshFormat::off, MeshFormat::stl};
constexpr std::array endings = {".obj", ".ply", ".off", ".stl"};

/// The triangles by the places of their corners, in any order, and what was left out.
std::string told(std::string_view bytes, MeshFormat format) {
  try {
    const MeshFile file = parse_mesh(std::as_bytes(std::span(bytes)), format);
    std::vector<std::string> triangles;
    for (std::size_t t = 0; t < file.scene.object_of_triangle.size(); ++t) {
      auto corners = corners_of<glm::vec3>(file.scene, t);
      const auto before = [](const glm::vec3& a, const glm::vec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
      };
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), before), corners.end());
      std::string text;
      for (const glm::vec3& p : corners) {
        for (const int axis : {0, 1, 2})
          text += (axis > 0 ? "," : " ") + std::to_string(p[axis]).substr(0, 3);
      }
      triangles.push_back(text);
    }
    std::sort(triangles.begin(), triangles.end());
    std::string result;
    for (const std::string& triangle : triangles) result += triangle + ";";
    for (const LeftOut& kind : file.left_out)
      result += " " + std::to_string(kind.count) + " " + kind.what + ";";
    return result;
  } catch (const FormatError& error) {
    return error.what();
  }
}

/// Two triangles that differ in all coordinates.
const std::string both = " 0.0,0.0,0.0 1.5,0.0,0.0 0.0,2.0,0.0; 0.0,2.0,0.0 1.5,0.0,0.0 4.0,5.0,3.0;";

const std::array<std::string, 4> texts = {
    "# made by hand\nv 0 0 0\nv 1.5 0 0\nv 0 2 0\nv 4 5 3\nf 1 2 3\nf 2 4 3\n",
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1.5 0 0\n0 2 0\n4 5 3\n3 0 1 2\n3 1 3 2\n",
    "OFF\n# made by hand\n4 2 0\n0 0 0\n1.5 0 0\n0 2 0\n4 5 3\n3 0 1 2\n3 1 3 2\n",
    "solid made by hand\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1.5 0 0\nvertex 0 2 "
    "0\nendloop\nendfacet\n"
    "facet normal 0 0 1\nouter loop\nvertex 1.5 0 0\nvertex 4 5 3\nvertex 0 2 0\nendloop\nendfacet\n"
    "endsolid made by hand\n"};

std::string replaced(std::string text, std::string_view old, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += with.size()) {
    text.replace(at, old.size(), with);
  }
  return text;
}

std::string utf16(std::string_view text, bool big_endian) {
  std::string result;
  for (const char c : text) result += big_endian ? "\0"s + c : c + "\0"s;
  return result;
}

std::string gzip(std::string_view text) {
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string result(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

struct Change {
  const char* name;
  std::function<std::string(const std::string&)> make;
};

std::string mixed_line_ends(const std::string& text) {
  std::string result;
  int line = 0;
  for (const char c : text)
    result += c == '\n' ? std::array{"\r", "\r\n", "\n"}[line++ % 3] : std::string(1, c);
  return result;
}

/// What systems make of a text; none changes which line is which.
const std::vector<Change> changes = {
    {"nothing", [](const std::string& t) { return t; }},
    {"mark of UTF-8", [](const std::string& t) { return "\xEF\xBB\xBF" + t; }},
    {"UTF-16 LE", [](const std::string& t) { return "\xFF\xFE" + utf16(t, false); }},
    {"UTF-16 BE", [](const std::string& t) { return "\xFE\xFF" + utf16(t, true); }},
    {"UTF-16 LE without a mark", [](const std::string& t) { return utf16(t, false); }},
    {"UTF-16 BE without a mark", [](const std::string& t) { return utf16(t, true); }},
    {"UTF-16 LE with CR LF",
     [](const std::string& t) { return "\xFF\xFE" + utf16(replaced(t, "\n", "\r\n"), false); }},
    {"a letter beyond UTF-16's first 65536",
     [](const std::string& t) {
       std::string text = utf16(t, false);
       const std::size_t at = text.find(utf16("made", false));
       return "\xFF\xFE" + text.replace(at, 8, "\x3D\xD8\x00\xDE\xAC\x20\xE9\x00"s);
     }},
    {"CR LF", [](const std::string& t) { return replaced(t, "\n", "\r\n"); }},
    {"CR", [](const std::string& t) { return replaced(t, "\n", "\r"); }},
    {"CR with a mark", [](const std::string& t) { return "\xEF\xBB\xBF" + replaced(t, "\n", "\r"); }},
    {"mixed line ends", mixed_line_ends},
    {"DOS end mark", [](const std::string& t) { return t + "\x1A"; }},
    {"DOS end mark on the last line",
     [](const std::string& t) { return t.substr(0, t.size() - 1) + "\x1A"; }},
    {"DOS end marks to a full block", [](const std::string& t) { return t + std::string(100, '\x1A'); }},
    {"DOS end mark, then 0", [](const std::string& t) { return t + "\r\n\x1A"s + std::string(100, '\0'); }},
    {"padding by 0", [](const std::string& t) { return t + std::string(600, '\0'); }},
    {"no last line end", [](const std::string& t) { return t.substr(0, t.size() - 1); }},
    {"tabs", [](const std::string& t) { return replaced(t, " ", "\t"); }},
    {"blanks around", [](const std::string& t) { return replaced(replaced(t, " ", "  "), "\n", " \t \n"); }},
    {"gzip", gzip},
    {"gzip in parts", [](const std::string& t) { return gzip(t.substr(0, 20)) + gzip(t.substr(20)); }}};

TEST(MeshDialects, TextOfEverySystemInEveryFormat) {
  for (const MeshFormat format : formats) {
    const std::size_t f = static_cast<std::size_t>(format);
    const std::string zero = replaced(texts[f], "4 5 3", "4 zero 3");
    const auto line =
        std::count(zero.begin(), zero.begin() + static_cast<std::ptrdiff_t>(zero.find("zero")), '\n') + 1;
    for (const Change& change : changes) {
      EXPECT_EQ(told(change.make(texts[f]), format), both) << endings[f] << ", " << change.name;
      EXPECT_EQ(told(change.make(zero), format), "line " + std::to_string(line) + ": 'zero' stands where a " +
                                                     (f == 1 ? "number" : "coordinate") + " is due")
          << endings[f] << ", " << change.name;
    }
  }
}

TEST(MeshDialects, FilesJoinedWithTheirMarks) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(told(mark + replaced(texts[0], "\n", "\n" + mark), MeshFormat::obj), both);
  EXPECT_EQ(told(mark + replaced(texts[2], "\n", "\n" + mark), MeshFormat::off), both);
  EXPECT_EQ(told(mark + replaced(texts[3], "\n", "\n" + mark), MeshFormat::stl), both);
  EXPECT_EQ(told(replaced(texts[0], "v 1.5", "\x1Av 1.5"), MeshFormat::obj), both);
  EXPECT_EQ(told(replaced(texts[2], "\n1.5", "\n\x1A\n1.5"), MeshFormat::off), both);
  EXPECT_EQ(told("\xFF\xFE\0\0v\0\0\0"sv, MeshFormat::obj), "is UTF-32; save it as UTF-8");
  EXPECT_EQ(told("\xFF\xFEv\0 "sv, MeshFormat::obj),
            "is UTF-16 of an odd number of bytes, so cut short; save it as UTF-8");
}

TEST(MeshDialects, NumbersOfEveryLanguage) {
  for (const MeshFormat format : formats) {
    const std::size_t f = static_cast<std::size_t>(format);
    const auto with = [&](std::string_view number) {
      return told(replaced(texts[f], "1.5", number), format);
    };
    for (const auto* number : {"1.5D+00", "1.5d0", "0.15D1", "15.0D-01", "+1.5", "+.15e1", "1.5E+000",
                               "15e-1", "1.5+00", "0.015+02", "15.-01", "1.5000000000000000000000000001"}) {
      EXPECT_EQ(with(number), both) << endings[f] << " " << number;
    }
    const std::string tiny = "0." + std::string(400, '0') + "1", huge = "1" + std::string(400, '0') + "e-400";
    EXPECT_EQ(told(replaced(texts[f], " 0 0\n", " " + tiny + " -1D-999\n"), format), both) << endings[f];
    EXPECT_EQ(told(replaced(texts[f], "1.5 0", "1.5 1e-99999999999999999999"), format), both) << endings[f];
    const std::string what = f == 1 ? "a number" : "a coordinate";
    for (const auto* word :
         {"0x1p3", "1.5e", "1.5D", "1.5+", "1-5", "+-1.5", "1.5e+3+3", "1.5x", "1e400x", "--1"}) {
      EXPECT_NE(with(word).find(": '"s + word + "' stands where " + what + " is due"), std::string::npos)
          << endings[f] << " " << with(word);
    }
    EXPECT_NE(
        with("1,5").find("'1,5' stands where " + what + " is due; write numbers with a point, not a comma"),
        std::string::npos);
    // What is no place is refused where it is used, with the word, which '#' does not cut.
    for (const auto* word : {"1.#INF", "-1.#INF00", "-1.#IND", "1.#QNAN0", "1.#SNAN", "-1.#J", "nan", "-nan",
                             "-nan(ind)", "inf", "Infinity", "1e400", "-1D+999", "1e10"}) {
      EXPECT_NE(with(word).find(", where '"s + word + "' is not a number within 1e9 of the origin"),
                std::string::npos)
          << endings[f] << " " << with(word);
    }
  }
  EXPECT_EQ(told(replaced(texts[0], "1.5 0 0", "1.5 0 0#1.#IND"), MeshFormat::obj), both) << "a comment";
  EXPECT_EQ(told(replaced(texts[0], "1.5 0 0", "1.5 0 0.# a comment"), MeshFormat::obj), both);
}

TEST(MeshDialects, PointsWithoutAPlace) {
  const std::string note = " 1 unused points that are not numbers within 1e9;";
  const std::string first = replaced(replaced(texts[0], "f 1 2 3", "f 2 3 4"), "f 2 4 3", "f 3 5 4");
  for (const auto* word : {"nan", "-1.#IND00", "inf", "1e400", "-2e9"}) {
    const std::string point = "v 0 "s + word + " 0\n";
    EXPECT_EQ(told(texts[0] + point, MeshFormat::obj), both + note) << word;
    EXPECT_EQ(told(point + first, MeshFormat::obj), both + note) << word;
  }
  EXPECT_EQ(told("v 0 0 nan\n" + texts[0], MeshFormat::obj),
            "line 7: uses the point of line 1, where 'nan' is not a number within 1e9 of the origin");
  EXPECT_EQ(told(texts[0] + "v nan 0 0\nf 1 2 6\n", MeshFormat::obj),
            "line 9: names a point that is not among the 5 of the file");
  EXPECT_EQ(told(replaced(replaced(texts[1], "vertex 4", "vertex 5"), "4 5 3\n", "4 5 3\nnan nan nan\n"),
                 MeshFormat::ply),
            both + note);
  EXPECT_EQ(
      told(replaced(replaced(texts[2], "4 2 0", "5 2 0"), "4 5 3\n", "4 5 3\nnan inf 0\n"), MeshFormat::off),
      both + note);
}

struct Dialect {
  const char* name;
  std::string text;
  std::string left_out;
};
void all_are_the_same(MeshFormat format, const std::vector<Dialect>& dialects) {
  for (const Dialect& dialect : dialects) {
    for (const Change& change : changes) {
      EXPECT_EQ(told(change.make("# made by hand\n" + dialect.text), format), both + dialect.left_out)
          << dialect.name << ", " << change.name;
    }
  }
}

TEST(MeshDialects, Obj) {
  const std::string points = "v 0 0 0\nv 1.5 0 0\nv 0 2 0\nv 4 5 3\n";
  all_are_the_same(
      MeshFormat::obj,
      {{"continued", points + "f 1 \\\n2 \\\n 3\nf 2\\\n 4 3\n", ""},
       {"blanks behind the backslash", points + "f 1 \\ \n2 \\\t \t\n 3\nf -3\\  \n -1 -2\n", ""},
       {"a point on three lines", replaced(points, "1.5 0 0", "1.5 \\ \n0 \\\t\n0") + "f 1 2 3\nf 2 4 3\n",
        ""},
       {"a comment with a backslash", points + "# a \\\nf 1 2 3 # \\\nf 2 4 3\n", ""},
       {"attributes",
        "mtllib a.mtl\no a\n" + points + "g b\nusemtl c\ns 1\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3/1\nfo 2 4 3\n",
        ""},
       {"lines and points", points + "l 1 2 3\np 1\nf 1 2 3\nf 2 4 3\np 2 3\n",
        " 3 lines and single points;"},
       {"other words", points + "vp 1 2\npolygon 1 2 3\nf 1 2 3\nf 2 4 3\nV 1 2 3\n",
        " 3 lines of other kinds ('vp' first);"}});
}

TEST(MeshDialects, Off) {
  const std::string points = "0 0 0\n1.5 0 0\n0 2 0\n4 5 3\n", faces = "3 0 1 2\n3 1 3 2\n";
  const std::string body = points + faces, colours = "3 0 1 2 255 0 0\n3 1 3 2 0.5 0.5 0.5 1\n";
  const auto with = [&](std::string_view more) {
    return replaced(points, "\n", " " + std::string(more) + "\n");
  };
  const auto broken = [](std::string text) { return replaced(std::move(text), " ", "\n"); };
  const auto joined = [](std::string text) { return replaced(std::move(text), "\n", " "); };
  all_are_the_same(
      MeshFormat::off,
      {{"plain", "OFF\n4 2 0\n" + body, ""},
       {"glued", "OFF4 2 0\n" + body, ""},
       {"one line", "OFF 4 2 0\n" + body, ""},
       {"lower case", "off\n4 2 0\n" + body, ""},
       {"no keyword", "4 2 0\n" + body, ""},
       {"no number of edges", "OFF\n4 2\n" + body, ""},
       {"no keyword, no number of edges", "4 2\n" + body, ""},
       {"counts on lines", "OFF\n4\n2\n0\n" + body, ""},
       {"edges on a line", "OFF\n4 2\n0\n" + body, ""},
       {"blank lines and comments", "OFF # a\n\n4 2 0 # b\n\n" + replaced(body, "\n", "\n\n# c\n"), ""},
       {"points on one line", "OFF\n4 2 0\n" + joined(points) + "\n" + faces, ""},
       {"points on the line of the counts", "OFF 4 2 0 " + joined(points) + "\n" + faces, ""},
       {"a number a line", "OFF\n4 2 0\n" + broken(points) + broken(faces), ""},
       {"a number a line, no number of edges", "OFF\n4 2\n" + broken(points) + faces, ""},
       {"all on one line", joined("OFF 4 2 0\n" + body) + "\n", ""},
       {"faces over lines", "OFF\n4 2 0\n" + points + "3 0\n1 2\n3 1 3\n2\n", ""},
       {"faces on one line", "OFF\n4 2 0\n" + points + joined(faces) + "\n", ""},
       {"colours of faces", "OFF\n4 2 0\n" + points + colours, ""},
       {"colours of faces, points on one line", "OFF\n4 2 0\n" + joined(points) + "\n" + colours, ""},
       {"one colour number", "OFF\n4 2 0\n" + points + "3 0 1 2 7\n3 1 3 2\n", ""},
       {"undeclared colours", "OFF\n4 2 0\n" + with("9 9 9") + colours, ""},
       {"COFF", "COFF\n4 2 0\n" + with("1 0 0 1") + colours, ""},
       {"COFF of three", "COFF\n4 2 0\n" + with("255 0 0") + faces, ""},
       {"COFF without colours", "COFF\n4 2 0\n" + body, ""},
       {"COFF on one line", "COFF\n4 2 0\n" + joined(with("1 0 0 1")) + "\n" + colours, ""},
       {"COFF of three on one line", "COFF\n4 2 0\n" + joined(with("255 0 0")) + "\n" + faces, ""},
       {"NOFF", "NOFF\n4 2 0\n" + with("0 0 1") + faces, ""},
       {"NOFF with normals on lines", "NOFF\n4 2 0\n" + with("\n0 0 1") + faces, ""},
       {"NCOFF", "NCOFF\n4 2 0\n" + with("0 0 1 255 0 0 255") + faces, ""},
       {"CNOFF", "CNOFF\n4 2 0\n" + with("0 0 1 255 0 0 255") + faces, ""},
       {"STOFF", "STOFF 4 2 0\n" + with("0.5 0.5") + faces, ""},
       {"STCNOFF", "STCNOFF\n4 2 0\n" + with("0 0 1 1 1 1 1 .5 .5") + faces, ""},
       {"STCNOFF, a number a line", "STCNOFF\n4 2 0\n" + broken(with("0 0 1 1 1 1 1 .5 .5")) + faces, ""},
       {"STCNOFF4", "STCNOFF4 2 0\n" + with("0 0 1 1 1 1 1 .5 .5") + faces, ""}});
  for (const auto* keyword : {"4OFF", "nOFF", "STCN4nOFF", "C4OFF"}) {
    EXPECT_EQ(told(keyword + "\n4 1 0\n"s + body, MeshFormat::off),
              "line 1: begins with '"s + keyword + "'; only points of three coordinates are read");
  }
  EXPECT_EQ(told("hello\n4 1 0\n" + body, MeshFormat::off),
            "line 1: begins with 'hello'; need OFF (or COFF, NOFF, STOFF, NCOFF and so on) with points of "
            "three coordinates");
}

TEST(MeshDialects, EveryShorterPrefixOfOffIsRefused) {
  for (const auto* text : {"OFF\n4 2 0\n0 0 0\n1.5 0 0\n0 2 0\n4 5 3\n3 0 1 2\n3 1 3 2",
                           "COFF4 2 0 0 0 0 1 1 1 1\n1 0 0 1 1 1 1 "
                           "0 1 0 1 1 1 1\n1 1 1 1 1 1 1\n3 0 1 2 1 1 1 1\n3 1 3 2"}) {
    ASSERT_EQ(told(text, MeshFormat::off).find("line"), std::string::npos);
    for (std::size_t size = 1; size < std::string_view(text).size(); ++size) {
      EXPECT_TRUE(told(std::string_view(text).substr(0, size), MeshFormat::off).starts_with("line")) << size;
    }
  }
}

TEST(MeshDialects, StlText) {
  const auto with = [](std::string_view old, std::string_view word) { return replaced(texts[3], old, word); };
  const std::string last = "endsolid made by hand\n";
  std::string upper = texts[3];
  for (char& c : upper) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  const std::size_t second = texts[3].find("facet normal", 30);
  for (const Dialect& dialect : std::vector<Dialect>{
           {"end solid", with("endsolid", "end solid"), ""},
           {"end loop", with("endloop", "end loop"), ""},
           {"end facet", with("endfacet", "end facet"), ""},
           {"glued", with("solid made", "solidmade"), ""},
           {"twice", "solid made by hand\n" + texts[3] + last, ""},
           {"twice in two words", texts[3] + "end solid made by hand\n", ""},
           {"colours", with("hand\nfacet", "hand\ncolor 0.1 0.2 0.3\nfacet"), " 1 colour lines;"},
           {"colours of facets", with("outer loop", "color 1 0 0\nouter loop"), " 2 colour lines;"},
           {"colours behind loops", with("endloop", "endloop\nCOLOR 1 0 0"), " 2 colour lines;"},
           {"several solids", std::string(texts[3]).insert(second, last + "solid\n"), ""},
           {"an empty solid", "solid empty made\nendsolid empty\n" + texts[3], ""},
           {"a name of keywords", with("by hand", "facet normal outer loop endsolid"), ""},
           {"no names", with(" made by hand", " "), ""},
           {"upper case", upper, ""},
           {"no normal", with("normal 0 0 1", "normal"), ""},
           {"a normal that is no number", with("normal 0 0 1", "normal -1.#IND nan -nan(ind)"), ""},
           {"a facet a line", replaced(replaced(texts[3], "\n", " "), "hand ", "hand\n"), ""}}) {
    for (const Change& change : changes) {
      if (dialect.text.find("made") == std::string::npos &&
          change.name == "a letter beyond UTF-16's first 65536"s)
        continue;
      EXPECT_EQ(told(change.make(dialect.text), MeshFormat::stl), both + dialect.left_out)
          << dialect.name << ", " << change.name;
    }
  }
  EXPECT_EQ(told(with(last, ""), MeshFormat::stl), "line 16: the file ends where endsolid is due")
      << "as if cut short";
  EXPECT_EQ(told(with("endfacet", "end"), MeshFormat::stl), "line 8: 'end' stands where endfacet is due");
  EXPECT_EQ(told("solid a\nendsolid a\n", MeshFormat::stl), "holds no triangles");
}

template <typename... Numbers>
std::string bytes_of(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

TEST(MeshDialects, StlBinary) {
  const auto file = [](std::string header, std::uint32_t count, std::string_view attributes) {
    header.resize(80, ' ');
    const auto size = static_cast<std::uint16_t>(attributes.size());
    for (const std::string& record :
         {bytes_of(0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.5f, 0.f, 0.f, 0.f, 2.f, 0.f, size),
          bytes_of(0.f, 0.f, 1.f, 1.5f, 0.f, 0.f, 4.f, 5.f, 3.f, 0.f, 2.f, 0.f, size)}) {
      header += (header.size() == 80 ? bytes_of(count) : "") + record + std::string(attributes);
    }
    return header;
  };
  const std::string plain = file("CAD", 2, "");
  constexpr auto stl = MeshFormat::stl;
  EXPECT_EQ(told(plain, stl), both);
  EXPECT_EQ(told(gzip(plain), stl), both);
  EXPECT_EQ(told(file("solid a", 2, ""), stl), both);
  for (const auto* header : {"CAD", "solid a", "solid a\nfacet"}) {
    EXPECT_EQ(told(file(header, 2, "abcd"), stl), both + " 8 bytes of attributes;") << header;
    EXPECT_EQ(told(file(header, 2, "") + "signed by CAD", stl), both + " 13 bytes after the last triangle;")
        << header;
    EXPECT_EQ(told(file(header, 0, ""), stl), both) << header;
    EXPECT_EQ(told(file(header, 0xffffffff, ""), stl), both) << header;
  }
  EXPECT_EQ(told(plain + std::string(412, '\0'), stl), both + " 412 bytes after the last triangle;");
  EXPECT_EQ(told(file("CAD", 1, ""), stl),
            " 0.0,0.0,0.0 1.5,0.0,0.0 0.0,2.0,0.0; 50 bytes after the last triangle;");
  std::string coloured = plain;
  coloured[84 + 48] = coloured[84 + 49] = '\x7F';  // a colour, as it does not say how many bytes follow
  EXPECT_EQ(told(coloured, stl), both);
  EXPECT_EQ(told(coloured + "x", stl), both + " 1 bytes after the last triangle;");
  EXPECT_EQ(told(file("CAD", 3, ""), stl), "says that it has 3 triangles, which take 234 bytes; it has 184");
  EXPECT_EQ(told(file("CAD", 3, "ab"), stl),
            "says that it has 3 triangles, which take 234 bytes; it has 188");
  for (std::size_t size = 1; size < plain.size(); ++size) {
    EXPECT_EQ(told(std::string_view(plain).substr(0, size), stl).find(both), std::string::npos) << size;
  }
  for (const std::uint32_t count : {0u, 0xffffffffu}) {
    EXPECT_EQ(told(file("CAD", count, "ab"), stl),
              "does not say how many triangles it has, and 104 bytes after the header are no whole number of "
              "them, each of 50");
    EXPECT_EQ(told(file("CAD", count, "").substr(0, 84), stl), "holds no triangles");
  }
}

TEST(MeshDialects, PlyHeadersAndElements) {
  const auto with = [](std::string_view old, std::string_view word) { return replaced(texts[1], old, word); };
  const std::string points = "0 0 0\n1.5 0 0\n0 2 0\n4 5 3\n";
  for (const Dialect& dialect : std::vector<Dialect>{
           {"vertex_index", with("vertex_indices", "vertex_index"), ""},
           {"comments", with("\n", "\n").insert(4, "comment element face 7\nobj_info made by hand\n"), ""},
           {"obj_info", with("end_header", "obj_info end_header\ncomment\nend_header"), ""},
           {"two elements of faces",
            with("element face 2\n",
                 "element face 1\nproperty list uchar int vertex_indices\nelement face 1\n"),
            ""},
           {"a camera",
            replaced(with("element face", "element camera 2\nproperty float f\nelement face"), points,
                     points + "7 8\n"),
            " 2 items of PLY's element 'camera';"},
           {"further words", texts[1] + "7 8 9\n", " 3 words after the last element;"},
           {"a strip",
            replaced(with("element face 2", "element tristrips 1"), "3 0 1 2\n3 1 3 2\n", "4 0 1 2 3\n"), ""},
           {"a face and a strip",
            replaced(with("element face 2",
                          "element face 1\nproperty list char uint vertex_index\nelement tristrips 1"),
                     "3 1 3 2\n", "3 1 3 2\n"),
            ""},
           {"strips restart turned as the first",
            replaced(with("element face 2", "element tristrips 1"), "3 0 1 2\n3 1 3 2\n",
                     "9 -1 0 1 2 -1 1 3 2 -1\n"),
            ""},
           {"two items of strips", with("element face 2", "element tristrips 2"), ""}}) {
    EXPECT_EQ(told(dialect.text, MeshFormat::ply), both + dialect.left_out) << dialect.name;
    EXPECT_EQ(told(replaced(dialect.text, "\n", "\r"), MeshFormat::ply), both + dialect.left_out)
        << dialect.name;
  }
}

TEST(MeshDialects, PlyOfEveryTypeAndLineEnd) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty uchar y\nproperty "
      "float z\n"
      "element NAME 1\nproperty list COUNT INDEX vertex_indices\nend_header\n";
  std::string points;
  for (const auto& [x, y, z] : {std::tuple{0., 0, 0.f}, {1.5, 0, 0.f}, {0., 2, 0.f}, {4., 5, 3.f}}) {
    points += bytes_of(x, static_cast<std::uint8_t>(y), z);
  }
  const auto number = [](std::string_view type, int value) {
    if (type == "char") return bytes_of(static_cast<std::int8_t>(value));
    if (type == "uchar") return bytes_of(static_cast<std::uint8_t>(value));
    if (type == "short") return bytes_of(static_cast<std::int16_t>(value));
    if (type == "ushort") return bytes_of(static_cast<std::uint16_t>(value));
    if (type == "int") return bytes_of(static_cast<std::int32_t>(value));
    if (type == "uint") return bytes_of(static_cast<std::uint32_t>(value));
    if (type == "float") return bytes_of(static_cast<float>(value));
    return bytes_of(static_cast<double>(value));
  };
  for (const auto* count : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"}) {
    for (const auto* index : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"}) {
      for (const auto* line_end : {"\n", "\r\n", "\r"}) {
        std::string text = replaced(replaced(header, "COUNT", count), "INDEX", index);
        text = replaced(replaced(text, "NAME", "tristrips"), "\n", line_end) + points + number(count, 4);
        for (const int point : {0, 1, 2, 3}) text += number(index, point);
        EXPECT_EQ(told(text, MeshFormat::ply), both) << count << " " << index;
        EXPECT_EQ(told("\xEF\xBB\xBF" + text, MeshFormat::ply), both) << count << " " << index;
        EXPECT_EQ(told(text + "\x1A", MeshFormat::ply), both + " 1 bytes after the last element;");
        EXPECT_NE(told(text.substr(0, text.size() - 1), MeshFormat::ply), both);
      }
    }
  }
  // Numbers that begin with the byte of a line end, behind each kind of line end.
  const std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement tristrips 1\nproperty list uchar uchar vertex_index\n"
      "element vertex 10\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (const auto* line_end : {"\n", "\r\n", "\r"}) {
    std::string text = replaced(bytes, "\n", line_end) + "\n\0\0\0\1\0\2\0\1\0\3"s;  // 10 corners
    for (int i = 0; i < 10; ++i) text += bytes_of(static_cast<float>(i), static_cast<float>(i * i), 0.f);
    EXPECT_EQ(parse_mesh(std::as_bytes(std::span(text)), MeshFormat::ply).scene.object_of_triangle.size(),
              8u);
  }
}

TEST(MeshDialects, StripsTurnEverySecondTriangle) {
  std::string text =
      replaced(replaced(texts[1], "element face 2", "element tristrips 1"), "vertex 4", "vertex 5");
  text = text.substr(0, text.find("4 5 3")) + "2 2 0\n4 2 0\n";
  const auto strip = [&](std::string_view list) {
    const std::string file = text + std::string(list) + "\n";
    return parse_mesh(std::as_bytes(std::span(file)), MeshFormat::ply).scene.indices;
  };
  using Indices = std::vector<std::uint32_t>;
  EXPECT_EQ(strip("5 0 1 2 3 4"), (Indices{0, 1, 2, 2, 1, 3, 2, 3, 4}));
  EXPECT_EQ(strip("10 0 1 2 3 -1 2 3 4 -1 0"), (Indices{0, 1, 2, 2, 1, 3, 2, 3, 4}));
  text = replaced(text, "uchar int", "uchar uint");
  EXPECT_EQ(strip("7 0 1 2 4294967295 2 3 4"), (Indices{0, 1, 2, 2, 3, 4})) << "-1 in unsigned numbers";
  EXPECT_EQ(told(text + "4 0 1 2 -2\n", MeshFormat::ply),
            "line 16: a corner's number is not a whole number from 0 to 4294967294");
  EXPECT_EQ(told(text + "3 0 1 5\n", MeshFormat::ply),
            "face 0: names a point that is not among the 5 of the file");
}

TEST(MeshDialects, GzipIsUnpackedWithinBounds) {
  const std::string packed = gzip(texts[0]);
  EXPECT_EQ(told(packed + "\0\0\0"s, MeshFormat::obj), both + " 3 bytes after the packed data;");
  EXPECT_EQ(told(gzip(packed), MeshFormat::obj), "is packed by gzip twice; unpack it by gunzip");
  for (std::size_t size = 2; size < packed.size(); ++size) {
    EXPECT_TRUE(
        told(std::string_view(packed).substr(0, size), MeshFormat::obj).starts_with("gzip: ends early"))
        << size;
  }
  std::string damaged = packed;
  damaged[packed.size() - 6] ^= 1;
  EXPECT_TRUE(told(damaged, MeshFormat::obj).starts_with("gzip: is damaged"));
  const std::string bomb = gzip(std::string(30 << 20, '\n'));
  EXPECT_EQ(told(bomb, MeshFormat::obj),
            "gzip: unpacks to more than " + std::to_string((16 << 20) + 100 * bomb.size()) +
                " bytes, far more than files of this size do; unpack it with gunzip if that is right");

  const TemporaryFolder folder;
  for (const MeshFormat format : formats) {
    const std::size_t f = static_cast<std::size_t>(format);
    const std::string text = gzip(texts[f]), path = folder / ("a"s + endings[f] + ".GZ");
    EXPECT_EQ(mesh_format(path), format);
    write_file(path, std::as_bytes(std::span(text)));
    EXPECT_EQ(read_mesh(path).scene.object_of_triangle.size(), 2u);
  }
}

TEST(MeshDialects, ScenesTellWhatIsLeftOutAndWhatIsRead) {
  const TemporaryFolder folder;
  const std::string text = texts[0] + "l 1 2\nv nan 0 0\n";
  write_file(folder / "a.obj", std::as_bytes(std::span(text)));
  const AnyScene scene = read_any_scene(folder / "a.obj");
  ASSERT_EQ(scene.left_out.size(), 2u);
  EXPECT_EQ(scene.left_out[0], "1 unused points that are not numbers within 1e9 left out");
  EXPECT_EQ(scene.left_out[1], "1 lines and single points left out");
  for (const auto* name : {"a.glb", "a.bsp.gz", "a"}) {
    write_file(folder / name, std::as_bytes(std::span(text)));
    try {
      read_any_scene(folder / name);
      ADD_FAILURE() << name;
    } catch (const FormatError& error) {
      EXPECT_EQ(error.what(), std::string(folder / name) +
                                  ": its ending names no kind of file that is read: .obj, .ply, .off or .stl "
                                  "(also before .gz), .bsp, .pk3, .scene.h5");
    }
  }
}

}  // namespace
}  // namespace vismat::mesh_dialects

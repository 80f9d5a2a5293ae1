// SPDX-License-Identifier: Apache-2.0
#include "drawing/svg.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "drawing/png_file.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kNamespaces =
    " xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink'";

std::string Document(const std::string& attributes, const std::string& content) {
  return "<svg" + kNamespaces + " " + attributes + ">" + content + "</svg>";
}

Result<DrawnSvg> DrawText(const std::string& document) {
  return DrawSvg({reinterpret_cast<const std::uint8_t*>(document.data()), document.size()});
}

// The pixel at a place in user units; clear outside the texture.
Colour ColourAt(const DrawnSvg& drawn, double x, double y) {
  const Point texel = (Point(x, y) - drawn.texture.origin) * drawn.texture.scale;
  const Image& image = drawn.texture.image;
  const int column = static_cast<int>(texel.x()), row = static_cast<int>(texel.y());
  if (texel.x() < 0 || texel.y() < 0 || column >= image.width || row >= image.height) return kClear;
  const std::uint8_t* p = image.at(column, row);
  return {p[0], p[1], p[2], p[3]};
}

std::string Gzip(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, text.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string Base64(const std::vector<std::uint8_t>& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < 3; ++i)
      group = group << 8 | (k + i < bytes.size() ? bytes[k + i] : 0);
    for (std::size_t i = 0; i < 4; ++i) {
      text += k + i <= bytes.size() ? digits[group >> (18 - 6 * i) & 63] : '=';
    }
  }
  return text;
}

TEST(DrawSvg, PlacesPixelsInUserUnitsOfTheViewBox) {
  const auto drawn = DrawText(Document("width='10cm' height='1cm' viewBox='-50 100 200 100'",
                                       "<rect x='-40' y='110' width='20' height='30' fill='red'/>"
                                       "<rect x='100' y='150' width='40' height='40'/>"));
  ASSERT_TRUE(drawn) << drawn.error().message;
  EXPECT_EQ(drawn->width, 200);
  EXPECT_EQ(drawn->height, 100);
  EXPECT_EQ(ColourAt(*drawn, -39, 111), kRed);
  EXPECT_EQ(ColourAt(*drawn, -21, 139), kRed);
  EXPECT_EQ(ColourAt(*drawn, -19, 139), kClear);
  EXPECT_EQ(ColourAt(*drawn, 139, 189), kBlack);
  EXPECT_EQ(ColourAt(*drawn, 141, 189), kClear);
  EXPECT_THAT(drawn->warnings, IsEmpty());
}

TEST(DrawSvg, TakesTheCanvasFromWidthAndHeightOrFromWhatIsDrawn) {
  const std::string circle = "<circle cx='30' cy='20' r='10' fill='blue'/>";
  const auto sized = DrawText(Document("width='72pt' height='48'", circle));
  ASSERT_TRUE(sized) << sized.error().message;
  EXPECT_DOUBLE_EQ(sized->width, 96);
  EXPECT_DOUBLE_EQ(sized->height, 48);
  EXPECT_EQ(ColourAt(*sized, 30, 20), kBlue);
  for (const char* attributes : {"", "width='100%' height='100%'"}) {
    const auto bare = DrawText(Document(attributes, circle));
    ASSERT_TRUE(bare) << attributes << ": " << bare.error().message;
    EXPECT_NEAR(bare->width, 20, 0.1) << attributes;
    EXPECT_EQ(ColourAt(*bare, 30, 20), kBlue) << attributes;
    EXPECT_EQ(ColourAt(*bare, 21.5, 20), kBlue) << attributes;
    EXPECT_EQ(ColourAt(*bare, 21.5, 12), kClear) << attributes;
  }
  for (const char* attributes : {"width='80%'", "width='20px'", "height='50%' width='100%'"}) {
    EXPECT_THAT(DrawText(Document(attributes, circle)),
                FailsSaying(ErrorCode::kImageUndecodable, "no size"));
  }
  const auto beyond = DrawText(Document("", "<rect x='-90' y='-5' width='1000' height='20'/>"));
  ASSERT_TRUE(beyond) << beyond.error().message;
  EXPECT_EQ(ColourAt(*beyond, 5, 5), kBlack);
  EXPECT_EQ(ColourAt(*beyond, -80, 0), kBlack);
  EXPECT_EQ(ColourAt(*beyond, 900, 10), kBlack);
}

TEST(DrawSvg, SpendsItsPixelsOnWhatIsDrawn) {
  const auto drawn = DrawText(
      Document("viewBox='0 0 10000 10000'", "<rect x='7000' y='2000' width='30' height='20'/>"));
  ASSERT_TRUE(drawn) << drawn.error().message;
  EXPECT_GT(drawn->texture.scale, 10.0);
  EXPECT_LE(std::max(drawn->texture.image.width, drawn->texture.image.height), kSvgTexels + 1);
  EXPECT_EQ(ColourAt(*drawn, 7001, 2001), kBlack);
  EXPECT_EQ(ColourAt(*drawn, 7029, 2019), kBlack);
  EXPECT_EQ(ColourAt(*drawn, 6999, 2001), kClear);
}

TEST(DrawSvg, ReadsAGzippedDocumentAndNoBombs) {
  const auto drawn = DrawText(Gzip(Document("viewBox='0 0 9 9'", "<rect width='5' height='5'/>")));
  ASSERT_TRUE(drawn) << drawn.error().message;
  const std::string bomb = Gzip("<svg>" + std::string(40 << 20, ' ') + "</svg>");
  ASSERT_LT(bomb.size(), 100'000u);
  EXPECT_THAT(DrawText(bomb), FailsSaying(ErrorCode::kImageTooLarge, "32 MiB"));
  const std::string whole = Gzip(Document("viewBox='0 0 9 9'", "<rect width='5' height='5'/>"));
  EXPECT_THAT(DrawText(whole.substr(0, whole.size() / 2)),
              FailsSaying(ErrorCode::kImageUndecodable, "gzip"));
}

TEST(DrawSvg, DrawsStylesGradientsAndEmbeddedPictures) {
  const std::string picture = Base64(EncodePng(PictureOf(4, 4, kGreen)));
  const auto drawn = DrawText(
      Document("viewBox='0 0 30 10'",
               "<style>.ink { fill: #0000ff }</style>"
               "<linearGradient id='g'><stop stop-color='red'/><stop offset='1' stop-color='red'/>"
               "</linearGradient><rect width='10' height='10' fill='url(#g)'/>"
               "<rect class='ink' x='10' width='10' height='10'/>"
               "<image x='20' width='10' height='10' xlink:href='data:image/png;base64," +
                   picture + "'/>"));
  ASSERT_TRUE(drawn) << drawn.error().message;
  EXPECT_EQ(ColourAt(*drawn, 5, 5), kRed);
  EXPECT_EQ(ColourAt(*drawn, 15, 5), kBlue);
  EXPECT_EQ(ColourAt(*drawn, 25, 5), kGreen);
  EXPECT_THAT(drawn->warnings, IsEmpty());
}

TEST(DrawSvg, LoadsNothingFromOutsideTheDocumentAndSaysSo) {
  const auto file = std::filesystem::temp_directory_path() / "posespace-svg-test.png";
  const auto png = EncodePng(PictureOf(4, 4, kGreen));
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  const std::string path = file.string();
  for (const std::string& target : {path, "file://" + path, std::string("http://localhost:1/a.png"),
                                    "../../../../../../../../" + path}) {
    const auto drawn =
        DrawText(Document("viewBox='0 0 20 10'",
                          "<rect width='10' height='10'/><image x='10' width='10' height='10' "
                          "xlink:href='" +
                              target + "'/>"));
    ASSERT_TRUE(drawn) << drawn.error().message;
    EXPECT_EQ(ColourAt(*drawn, 5, 5), kBlack);
    EXPECT_EQ(ColourAt(*drawn, 15, 5), kClear) << target;
    EXPECT_THAT(drawn->warnings, ElementsAre(HasSubstr("outside itself was not drawn")));
  }
  std::filesystem::remove(file);
}

TEST(DrawSvg, ReadsNoFileThroughAnEntity) {
  const auto drawn =
      DrawText("<!DOCTYPE svg [<!ENTITY secret SYSTEM 'file:///etc/passwd'>]>" +
               Document("viewBox='0 0 100 100'",
                        "<rect width='10' height='10'/><text y='50'>&secret;</text>"));
  if (drawn) {
    EXPECT_LT(drawn->texture.image.width / drawn->texture.scale, 15.0);  // nothing but the square
  } else {
    EXPECT_EQ(drawn.error().code, ErrorCode::kImageUndecodable);
  }
}

TEST(DrawSvg, RunsNoScripts) {
  const auto drawn = DrawText(
      Document("viewBox='0 0 20 10' onload=\"document.getElementById('r').setAttribute('x', 10)\"",
               "<script>document.getElementById('r').setAttribute('x', '10')</script>"
               "<rect id='r' width='10' height='10'/>"));
  ASSERT_TRUE(drawn) << drawn.error().message;
  EXPECT_EQ(ColourAt(*drawn, 5, 5), kBlack);
}

TEST(DrawSvg, SaysThatTextDependsOnFonts) {
  const auto drawn = DrawText(
      Document("viewBox='0 0 20 10'", "<rect width='10' height='10'/><text>posespace</text>"));
  ASSERT_TRUE(drawn) << drawn.error().message;
  EXPECT_THAT(drawn->warnings, ElementsAre(HasSubstr("fonts")));
}

TEST(DrawSvg, RefusesWhatIsNoDrawing) {
  EXPECT_THAT(DrawText(""), FailsWith(ErrorCode::kImageUndecodable));
  EXPECT_THAT(DrawText("hello"), FailsSaying(ErrorCode::kImageUndecodable, "no SVG document"));
  EXPECT_THAT(DrawText("<html/>"), FailsWith(ErrorCode::kImageUndecodable));
  EXPECT_THAT(DrawText(Document("", "<rect")), FailsWith(ErrorCode::kImageUndecodable));
  EXPECT_THAT(DrawText(Document("viewBox='0 0 9 9'", "")), FailsWith(ErrorCode::kOutlineEmpty));
  EXPECT_THAT(DrawText(Document("", "")), FailsWith(ErrorCode::kOutlineEmpty));
  EXPECT_THAT(DrawText(Document("viewBox='0 0 9 9'", "<rect x='50' width='9' height='9'/>")),
              FailsSaying(ErrorCode::kOutlineEmpty, "nothing on its canvas"));
}

TEST(DrawSvg, RefusesACanvasOfNoSizeOrBeyondTheLimit) {
  const std::string square = "<rect width='10' height='10'/>";
  for (const char* attributes :
       {"viewBox='0 0 1e7 10'", "width='1e9' height='1e9'", "viewBox='2e6 0 10 10'",
        "viewBox='0 0 1e-9 1e-9'", "viewBox='0 0 0 0' width='0' height='0'"}) {
    const auto drawn = DrawText(Document(attributes, square));
    ASSERT_FALSE(drawn) << attributes;
    EXPECT_TRUE(drawn.error().code == ErrorCode::kImageTooLarge ||
                drawn.error().code == ErrorCode::kImageUndecodable ||
                drawn.error().code == ErrorCode::kOutlineEmpty)
        << attributes << ": " << drawn.error().message;
  }
  EXPECT_TRUE(DrawText(Document("viewBox='0 0 1e6 1e6'", "<rect width='5e5' height='5e5'/>")));
}

TEST(DrawSvg, SurvivesDocumentsThatTakeForEverOrAllMemory) {
  // A billion laughs, by entities and by nested uses; a million elements deep; a huge picture.
  std::string entities = "<!DOCTYPE svg [<!ENTITY a 'hahahahahaha'>";
  std::string uses = "<g id='u0'><rect width='9' height='9'/></g>";
  for (int k = 1; k < 12; ++k) {
    const std::string name(1, static_cast<char>('a' + k)),
        before(1, static_cast<char>('a' + k - 1));
    entities += "<!ENTITY " + name + " '";
    uses += "<g id='u" + std::to_string(k) + "'>";
    for (int i = 0; i < 10; ++i) {
      entities += "&" + before + ";";
      uses += "<use xlink:href='#u" + std::to_string(k - 1) + "'/>";
    }
    entities += "'>";
    uses += "</g>";
  }
  std::string deep;
  for (int k = 0; k < 300'000; ++k) deep += "<g>";
  std::string blurred =
      "<filter id='f'><feTurbulence baseFrequency='0.01' numOctaves='1000000'/>"
      "<feGaussianBlur stdDeviation='1e5'/></filter>";
  for (int k = 0; k < 200; ++k) blurred += "<rect width='100' height='100' filter='url(#f)'/>";
  for (const std::string& document :
       {entities + "]>" + Document("viewBox='0 0 9 9'", "<text>&l;</text>"),
        Document("viewBox='0 0 9 9'", "<defs>" + uses + "</defs><use xlink:href='#u11'/>"),
        "<svg" + kNamespaces + " viewBox='0 0 9 9'>" + deep,
        Document("viewBox='0 0 100 100'", blurred)}) {
    const auto drawn = DrawText(document);
    if (drawn) continue;
    EXPECT_TRUE(drawn.error().code == ErrorCode::kImageUndecodable ||
                drawn.error().code == ErrorCode::kImageTooLarge ||
                drawn.error().code == ErrorCode::kOutlineEmpty)
        << drawn.error().message;
  }
  EXPECT_TRUE(DrawText(Document("viewBox='0 0 9 9'", "<rect width='5' height='5'/>")));
}

TEST(DrawSvg, AnswersMutatedDocumentsWithAnErrorOrAPicture) {
  std::mt19937 random(17);
  const std::string whole = Document(
      "width='40' height='30' viewBox='-5 -5 40 30'",
      "<defs><linearGradient id='g'><stop stop-color='red'/></linearGradient></defs>"
      "<path d='M0 0 C10 0 20 10 20 20 z' fill='url(#g)' stroke='blue' stroke-width='2'/>");
  for (int round = 0; round < 40; ++round) {
    std::string document = whole;
    for (int k = 0; k < 1 + round % 4; ++k) {
      document[random() % document.size()] = static_cast<char>(random());
    }
    const auto drawn = DrawText(document);
    if (drawn) {
      const Image& image = drawn->texture.image;
      EXPECT_EQ(image.rgba.size(), 4u * image.width * image.height);
      continue;
    }
    EXPECT_NE(drawn.error().code, ErrorCode::kInternal) << drawn.error().message << document;
  }
}

}  // namespace
}  // namespace posespace

// SPDX-License-Identifier: Apache-2.0
#include "rpc/frame_result_writer.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace posespace {
namespace {

using ::google::protobuf::util::MessageDifferencer;

v1::PlayResponse Read(const MessageBytes& bytes) {
  v1::PlayResponse response;
  EXPECT_TRUE(response.ParseFromArray(bytes.view().data(), static_cast<int>(bytes.size())));
  return response;
}

v1::Frame FrameOf(std::span<const float> vertices, v1::VertexFormat format) {
  ItemAnswer item;
  item.vertices = vertices;
  return Read(WriteFrameResult(1, {&item, 1}, 0, format)).frame_result().items(0).frame();
}

// As clients read them.
std::vector<double> Decoded(const v1::QuantizedVertices& quantized) {
  std::vector<std::int16_t> steps(quantized.values().size() / sizeof(std::int16_t));
  std::memcpy(steps.data(), quantized.values().data(), quantized.values().size());
  std::vector<double> values;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const double center = k % 2 == 0 ? quantized.center_x() : quantized.center_y();
    values.push_back(center + static_cast<double>(quantized.step()) * steps[k]);
  }
  return values;
}

TEST(WriteFrameResult, WritesWhatProtobufWould) {
  const std::vector<float> vertices = {1.0f, -2.5f, 3e9f, 0.0f};
  const std::vector<double> weights = {0.25, 0.75}, textures = {0.0, 1.0};
  std::vector<ItemAnswer> items(4);
  items[0] = {.slot = 63, .tag = 4'000'000'000u, .vertices = vertices, .folds = 3, .mended = 130};
  items[0].fading = true;
  items[1] = {.vertices = vertices, .weights = weights, .texture_weights = textures};
  items[2] = {.slot = 1, .reason = "SLOT_NOT_BOUND", .error_message = std::string(300, 'x')};
  items[3] = {.tag = 128};  // no vertices at all

  v1::PlayResponse expected;
  auto& result = *expected.mutable_frame_result();
  result.set_frame_id(std::numeric_limits<std::uint64_t>::max());
  result.set_superseded(7);
  for (const ItemAnswer& item : items) {
    auto& answer = *result.add_items();
    answer.set_slot(item.slot);
    answer.set_tag(item.tag);
    answer.set_reason(item.reason);
    answer.set_error_message(item.error_message);
    if (!item.reason.empty()) continue;
    answer.set_fading(item.fading);
    auto& frame = *answer.mutable_frame();
    frame.set_vertices(item.vertices.data(), item.vertices.size_bytes());
    frame.mutable_weights()->Assign(item.weights.begin(), item.weights.end());
    frame.mutable_texture_weights()->Assign(item.texture_weights.begin(),
                                            item.texture_weights.end());
    frame.set_folds(item.folds);
    frame.set_mended(item.mended);
  }
  const auto written =
      Read(WriteFrameResult(result.frame_id(), items, 7, v1::VERTEX_FORMAT_UNSPECIFIED));
  EXPECT_TRUE(MessageDifferencer::Equals(written, expected)) << written.ShortDebugString();
}

TEST(WriteFrameResult, WritesAResultWithoutItemsOrNumber) {
  const auto written = Read(WriteFrameResult(0, {}, 0, v1::VERTEX_FORMAT_FLOAT32));
  EXPECT_TRUE(written.has_frame_result());
  EXPECT_EQ(written.frame_result().items_size(), 0);
}

TEST(WriteFrameResult, MovesInt16VerticesByNoMoreThanHalfAStep) {
  std::mt19937 random(1);
  for (const double size : {1e-3, 1.0, 500.0, 30'000.0}) {
    for (const double away : {0.0, 1.0, 100.0}) {
      std::uniform_real_distribution<double> x(away * size, (away + 1.0) * size);
      std::uniform_real_distribution<double> y(-0.2 * size, 0.1 * size);
      std::vector<float> vertices;
      for (int k = 0; k < 300; ++k) {
        vertices.push_back(static_cast<float>(x(random)));
        vertices.push_back(static_cast<float>(y(random)));
      }
      const v1::Frame frame = FrameOf(vertices, v1::VERTEX_FORMAT_INT16);
      EXPECT_TRUE(frame.vertices().empty());
      const v1::QuantizedVertices& quantized = frame.quantized();
      EXPECT_EQ(quantized.values().size(), vertices.size() * sizeof(std::int16_t));
      EXPECT_LE(quantized.step(), size / 65'530.0);
      const std::vector<double> decoded = Decoded(quantized);
      const double rounding = 2e-7 * (away + 1.0) * size;
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        ASSERT_NEAR(decoded[k], vertices[k], 0.51 * quantized.step() + rounding) << k;
      }
    }
  }
}

TEST(WriteFrameResult, KeepsTheEndsOfTheBoxOnTheGrid) {
  const std::vector<float> vertices = {0.0f, 0.0f, 655.34f, 10.0f};
  const auto decoded = Decoded(FrameOf(vertices, v1::VERTEX_FORMAT_INT16).quantized());
  for (std::size_t k = 0; k < vertices.size(); ++k) EXPECT_NEAR(decoded[k], vertices[k], 0.0051);
}

TEST(WriteFrameResult, TakesVerticesThatAreAllInOnePlace) {
  const std::vector<float> vertices = {7.0f, -3.0f, 7.0f, -3.0f};
  const auto quantized = FrameOf(vertices, v1::VERTEX_FORMAT_INT16).quantized();
  EXPECT_EQ(quantized.step(), 0.0f);
  EXPECT_THAT(Decoded(quantized), ::testing::ElementsAre(7.0, -3.0, 7.0, -3.0));
}

TEST(WriteFrameResult, TakesVerticesAtTheEndsOfFloat) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  const std::vector<float> vertices = {-kLargest, -kLargest, kLargest, kLargest};
  const auto quantized = FrameOf(vertices, v1::VERTEX_FORMAT_INT16).quantized();
  EXPECT_TRUE(std::isfinite(quantized.step()));
  EXPECT_NEAR(Decoded(quantized)[2] / kLargest, 1.0, 1e-6);
}

}  // namespace
}  // namespace posespace

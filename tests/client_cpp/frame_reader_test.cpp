// SPDX-License-Identifier: Apache-2.0
#include "client/cpp/frame_reader.h"

#include <gmock/gmock.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <random>

#include "posespace/v1/pose_service.pb.h"

namespace posespace::internal {
namespace {

using google::protobuf::io::ArrayInputStream;

// As gRPC hands it over: in pieces of `block` bytes.
ReadOutcome Read(const std::string& bytes, std::uint64_t* frame_id, FrameItems* items,
                 int block = -1) {
  ArrayInputStream stream(bytes.data(), static_cast<int>(bytes.size()), block);
  return ReadFrameResult(&stream, frame_id, items);
}

v1::PlayResponse RandomResult(std::mt19937& random) {
  const auto upTo = [&](unsigned most) { return static_cast<int>(random() % (most + 1)); };
  v1::PlayResponse response;
  auto& result = *response.mutable_frame_result();
  result.set_frame_id(random() % 3 == 0 ? 0 : random() * 4'294'967'296ull + random());
  for (int count = upTo(6); count > 0; --count) {
    auto& item = *result.add_items();
    item.set_slot(random() % 2 == 0 ? 0 : random());
    item.set_tag(random());
    if (random() % 4 == 0) {
      item.set_reason("POSE_NOT_FINITE");
      item.set_error_message(std::string(static_cast<std::size_t>(upTo(40)), 'x'));
      continue;
    }
    item.set_fading(random() % 2 == 0);
    auto& frame = *item.mutable_frame();
    std::string& vertices = *frame.mutable_vertices();
    for (int k = 8 * upTo(50); k > 0; --k) vertices += static_cast<char>(random() % 60);
    for (int k = upTo(5); k > 0; --k) frame.add_weights(0.1 * static_cast<double>(random() % 100));
    for (int k = upTo(5); k > 0; --k) frame.add_texture_weights(0.5);
    frame.set_folds(upTo(2) - 1);
    frame.set_mended(upTo(3));
  }
  return response;
}

void ExpectSame(const v1::PlayResponse::FrameResult& result, const FrameItems& items) {
  ASSERT_EQ(items.count, static_cast<std::size_t>(result.items_size()));
  for (std::size_t k = 0; k < items.count; ++k) {
    const auto& expected = result.items(static_cast<int>(k));
    const FrameItems::Item& item = items.items[k];
    EXPECT_EQ(item.slot, expected.slot());
    EXPECT_EQ(item.tag, expected.tag());
    EXPECT_EQ(item.folds, expected.frame().folds());
    EXPECT_EQ(item.mended, expected.frame().mended());
    EXPECT_EQ(item.fading, expected.fading());
    EXPECT_EQ(item.reason, expected.reason());
    EXPECT_EQ(item.message, expected.error_message());
    const std::string vertices(
        reinterpret_cast<const char*>(items.vertices.data() + item.vertices_begin),
        sizeof(float) * (item.vertices_end - item.vertices_begin));
    EXPECT_EQ(vertices, expected.frame().vertices());
    const auto numbers = [&](int begin, int end) {
      return std::vector<double>(items.numbers.begin() + begin, items.numbers.begin() + end);
    };
    EXPECT_THAT(numbers(item.weights_begin, item.weights_end),
                ::testing::ElementsAreArray(expected.frame().weights()));
    EXPECT_THAT(numbers(item.textures_begin, item.textures_end),
                ::testing::ElementsAreArray(expected.frame().texture_weights()));
  }
}

TEST(FrameReader, ReadsWhatProtobufReadsAlsoInPieces) {
  std::mt19937 random(1);
  FrameItems items;  // the same memory all along
  for (int round = 0; round < 500; ++round) {
    const v1::PlayResponse response = RandomResult(random);
    items.Clear();
    std::uint64_t frame_id = 0;
    const int block = round % 3 == 0 ? -1 : 1 + round % 23;
    ASSERT_EQ(Read(response.SerializeAsString(), &frame_id, &items, block),
              ReadOutcome::kFrameResult);
    EXPECT_EQ(frame_id, response.frame_result().frame_id());
    ExpectSame(response.frame_result(), items);
  }
}

TEST(FrameReader, AppendsTheItemsOfSeveralMessages) {
  std::mt19937 random(2);
  v1::PlayResponse both = RandomResult(random), second = RandomResult(random);
  FrameItems items;
  std::uint64_t frame_id = 0;
  Read(both.SerializeAsString(), &frame_id, &items);
  Read(second.SerializeAsString(), &frame_id, &items);
  both.mutable_frame_result()->mutable_items()->MergeFrom(second.frame_result().items());
  ExpectSame(both.frame_result(), items);
}

TEST(FrameReader, LeavesOtherMessagesToProtobuf) {
  v1::PlayResponse welcome, heartbeat;
  welcome.mutable_welcome()->set_max_items(5);
  heartbeat.mutable_heartbeat();
  FrameItems items;
  std::uint64_t frame_id = 0;
  for (const auto& message : {welcome, heartbeat, v1::PlayResponse()}) {
    EXPECT_EQ(Read(message.SerializeAsString(), &frame_id, &items), ReadOutcome::kAnotherMessage);
    EXPECT_EQ(items.count, 0u);
  }
}

TEST(FrameReader, SkipsFieldsOfLaterVersions) {
  v1::PlayResponse response;
  auto& item = *response.mutable_frame_result()->add_items();
  item.set_tag(7);
  item.mutable_frame()->set_vertices("12345678");
  const auto add = [](google::protobuf::Message& message) {
    auto& unknown = *message.GetReflection()->MutableUnknownFields(&message);
    unknown.AddVarint(900, 1);
    unknown.AddLengthDelimited(901, "later");
    unknown.AddFixed64(902, 2);
  };
  add(item);
  add(*item.mutable_frame());
  add(*response.mutable_frame_result());
  FrameItems items;
  std::uint64_t frame_id = 0;
  ASSERT_EQ(Read(response.SerializeAsString(), &frame_id, &items), ReadOutcome::kFrameResult);
  ExpectSame(response.frame_result(), items);
}

// With the steps given as bytes.
v1::PlayResponse QuantizedResult(const std::string& values) {
  v1::PlayResponse response;
  auto& grid = *response.mutable_frame_result()->add_items()->mutable_frame()->mutable_quantized();
  grid.set_center_x(100.0f);
  grid.set_center_y(-7.0f);
  grid.set_step(0.5f);
  grid.set_values(values);
  return response;
}

TEST(FrameReader, ReadsQuantizedVerticesAsFloats) {
  const std::int16_t steps[] = {0, 1, -32767, 32767};
  const std::string values(reinterpret_cast<const char*>(steps), sizeof(steps));
  for (const int block : {-1, 1, 3}) {
    FrameItems items;
    std::uint64_t frame_id = 0;
    ASSERT_EQ(Read(QuantizedResult(values).SerializeAsString(), &frame_id, &items, block),
              ReadOutcome::kFrameResult);
    ASSERT_EQ(items.floats, 4u);
    EXPECT_EQ(items.items[0].vertices_end - items.items[0].vertices_begin, 4u);
    EXPECT_THAT(std::vector<float>(items.vertices.begin(), items.vertices.begin() + 4),
                ::testing::ElementsAre(100.0f, -6.5f, -16283.5f, 16376.5f));
  }
}

TEST(FrameReader, RefusesEveryTruncatedMessageWithQuantizedVertices) {
  const std::string whole = QuantizedResult(std::string(40, 'x')).SerializeAsString();
  for (std::size_t size = 1; size < whole.size(); ++size) {
    FrameItems items;
    std::uint64_t frame_id = 0;
    EXPECT_EQ(Read(whole.substr(0, size), &frame_id, &items), ReadOutcome::kBroken) << size;
  }
}

TEST(FrameReader, RefusesEveryTruncatedMessage) {
  std::mt19937 random(3);
  v1::PlayResponse response = RandomResult(random);
  while (response.frame_result().items_size() < 3) response = RandomResult(random);
  const std::string whole = response.SerializeAsString();
  for (std::size_t length = 1; length < whole.size(); ++length) {
    FrameItems items;
    std::uint64_t frame_id = 0;
    EXPECT_EQ(Read(whole.substr(0, length), &frame_id, &items), ReadOutcome::kBroken) << length;
  }
}

}  // namespace
}  // namespace posespace::internal

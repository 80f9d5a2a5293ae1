// SPDX-License-Identifier: Apache-2.0
#include "rpc/frame_result_writer.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace posespace {
namespace {

using Wire = google::protobuf::internal::WireFormatLite;
using Item = v1::PlayResponse::ItemResult;
using FrameResult = v1::PlayResponse::FrameResult;

static_assert(std::endian::native == std::endian::little, "vertices travel little-endian");

// Bytes of a field's tag and its value: field numbers here are below 16.
constexpr std::size_t kTagBytes = 1;
std::size_t SizeOf(std::uint32_t value) {  // nothing for the default
  return value == 0 ? 0 : kTagBytes + Wire::UInt32Size(value);
}
std::size_t SizeOf(std::int32_t value) {
  return value == 0 ? 0 : kTagBytes + Wire::Int32Size(value);
}
std::size_t SizeOf(bool value) { return value ? kTagBytes + Wire::kBoolSize : 0; }
std::size_t SizeOf(std::uint64_t value) {
  return value == 0 ? 0 : kTagBytes + Wire::UInt64Size(value);
}
std::size_t SizeOfBytes(std::size_t count) { return kTagBytes + Wire::LengthDelimitedSize(count); }
std::size_t SizeOfText(const std::string& text) {
  return text.empty() ? 0 : SizeOfBytes(text.size());
}
std::size_t SizeOfNumbers(std::span<const double> numbers) {
  return numbers.empty() ? 0 : SizeOfBytes(numbers.size_bytes());
}

// Writes fields one after another; as proto3 has it, defaults are left out.
class Writer {
 public:
  explicit Writer(char* at) : at_(reinterpret_cast<std::uint8_t*>(at)) {}

  void Number(int field, std::uint32_t value) {
    if (value != 0) at_ = Wire::WriteUInt32ToArray(field, value, at_);
  }
  void Number(int field, std::int32_t value) {
    if (value != 0) at_ = Wire::WriteInt32ToArray(field, value, at_);
  }
  void Number(int field, std::uint64_t value) {
    if (value != 0) at_ = Wire::WriteUInt64ToArray(field, value, at_);
  }
  void Flag(int field, bool value) {
    if (value) at_ = Wire::WriteBoolToArray(field, value, at_);
  }
  void Number(int field, float value) { at_ = Wire::WriteFloatToArray(field, value, at_); }
  void Text(int field, const std::string& text) {
    if (text.empty()) return;
    Begin(field, text.size());
    Raw(text.data(), text.size());
  }
  void Numbers(int field, std::span<const double> numbers) {
    if (numbers.empty()) return;
    Begin(field, numbers.size_bytes());
    Raw(numbers.data(), numbers.size_bytes());
  }
  // A message or bytes of `count` bytes, which follow.
  void Begin(int field, std::size_t count) {
    at_ = Wire::WriteTagToArray(field, Wire::WIRETYPE_LENGTH_DELIMITED, at_);
    at_ = google::protobuf::io::CodedOutputStream::WriteVarint32ToArray(
        static_cast<std::uint32_t>(count), at_);
  }
  void Raw(const void* bytes, std::size_t count) {
    if (count == 0) return;  // the pointer may be null then
    std::memcpy(at_, bytes, count);
    at_ += count;
  }

 private:
  std::uint8_t* at_;
};

constexpr std::size_t kGridBytes = 3 * (kTagBytes + sizeof(float));

std::size_t ValueBytes(const ItemAnswer& item) {
  return item.vertices.size() * sizeof(std::int16_t);
}
std::size_t SizeOfQuantized(const ItemAnswer& item) {
  return kGridBytes + SizeOfBytes(ValueBytes(item));
}

std::size_t SizeOfFrame(const ItemAnswer& item, bool quantized) {
  return SizeOfBytes(quantized ? SizeOfQuantized(item) : item.vertices.size_bytes()) +
         SizeOfNumbers(item.weights) + SizeOfNumbers(item.texture_weights) + SizeOf(item.folds) +
         SizeOf(item.mended);
}

std::size_t SizeOfItem(const ItemAnswer& item, bool quantized) {
  const std::size_t names = SizeOf(item.slot) + SizeOf(item.tag);
  if (item.reason.empty()) {
    return names + SizeOfBytes(SizeOfFrame(item, quantized)) + SizeOf(item.fading);
  }
  return names + SizeOfText(item.reason) + SizeOfText(item.error_message);
}

// The grid of 65,535 steps over the longer side of the vertices' box, and the vertices on it.
void WriteQuantized(const ItemAnswer& item, Writer* writer) {
  using Quantized = v1::QuantizedVertices;
  constexpr float kMost = 32'767.0f;
  constexpr float kLeastSize = 1e-20f;  // far below any pixel; its inverse is finite
  float low[2] = {0.0f, 0.0f}, high[2] = {0.0f, 0.0f};
  for (std::size_t k = 0; k < item.vertices.size(); ++k) {
    const float value = item.vertices[k];
    low[k % 2] = k < 2 ? value : std::min(low[k % 2], value);
    high[k % 2] = k < 2 ? value : std::max(high[k % 2], value);
  }
  const float center[2] = {0.5f * low[0] + 0.5f * high[0], 0.5f * low[1] + 0.5f * high[1]};
  const float half = std::max(0.5f * high[0] - 0.5f * low[0], 0.5f * high[1] - 0.5f * low[1]);
  const bool has_size = half > kLeastSize;
  const float step = has_size ? half / kMost : 0.0f;
  const float steps = has_size ? kMost / half : 0.0f;

  writer->Number(Quantized::kCenterXFieldNumber, center[0]);
  writer->Number(Quantized::kCenterYFieldNumber, center[1]);
  writer->Number(Quantized::kStepFieldNumber, step);
  writer->Begin(Quantized::kValuesFieldNumber, ValueBytes(item));
  for (std::size_t k = 0; k < item.vertices.size(); ++k) {
    const float place = (item.vertices[k] - center[k % 2]) * steps;
    const auto value = static_cast<std::int16_t>(std::lrint(std::clamp(place, -kMost, kMost)));
    writer->Raw(&value, sizeof(value));
  }
}

void WriteItem(const ItemAnswer& item, bool quantized, Writer* writer) {
  writer->Number(Item::kSlotFieldNumber, item.slot);
  writer->Number(Item::kTagFieldNumber, item.tag);
  if (!item.reason.empty()) {
    writer->Text(Item::kReasonFieldNumber, item.reason);
    writer->Text(Item::kErrorMessageFieldNumber, item.error_message);
    return;
  }
  writer->Begin(Item::kFrameFieldNumber, SizeOfFrame(item, quantized));
  if (!quantized) {
    writer->Begin(v1::Frame::kVerticesFieldNumber, item.vertices.size_bytes());
    writer->Raw(item.vertices.data(), item.vertices.size_bytes());
  }
  writer->Numbers(v1::Frame::kWeightsFieldNumber, item.weights);
  writer->Numbers(v1::Frame::kTextureWeightsFieldNumber, item.texture_weights);
  writer->Number(v1::Frame::kFoldsFieldNumber, item.folds);
  writer->Number(v1::Frame::kMendedFieldNumber, item.mended);
  if (quantized) {
    writer->Begin(v1::Frame::kQuantizedFieldNumber, SizeOfQuantized(item));
    WriteQuantized(item, writer);
  }
  writer->Flag(Item::kFadingFieldNumber, item.fading);
}

}  // namespace

MessageBytes WriteFrameResult(std::uint64_t frame_id, std::span<const ItemAnswer> items,
                              std::uint32_t superseded, v1::VertexFormat format) {
  const bool quantized = format == v1::VERTEX_FORMAT_INT16;
  std::size_t size = SizeOf(frame_id) + SizeOf(superseded);
  for (const ItemAnswer& item : items) size += SizeOfBytes(SizeOfItem(item, quantized));

  MessageBytes message(SizeOfBytes(size));
  Writer writer(message.data());
  writer.Begin(v1::PlayResponse::kFrameResultFieldNumber, size);
  writer.Number(FrameResult::kFrameIdFieldNumber, frame_id);
  for (const ItemAnswer& item : items) {
    writer.Begin(FrameResult::kItemsFieldNumber, SizeOfItem(item, quantized));
    WriteItem(item, quantized, &writer);
  }
  writer.Number(FrameResult::kSupersededFieldNumber, superseded);
  return message;
}

}  // namespace posespace

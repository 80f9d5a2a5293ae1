// SPDX-License-Identifier: Apache-2.0
#include "client/cpp/frame_reader.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <bit>

#include "posespace/v1/pose_service.pb.h"

namespace posespace::internal {
namespace {

using google::protobuf::io::CodedInputStream;
using google::protobuf::io::ZeroCopyInputStream;
using Wire = google::protobuf::internal::WireFormatLite;

static_assert(std::endian::native == std::endian::little, "vertices travel little-endian");

// Tags of fields, by wire type.
constexpr std::uint32_t Varint(int number) { return static_cast<std::uint32_t>(number) << 3; }
constexpr std::uint32_t Bytes(int number) { return Varint(number) | 2; }
constexpr std::uint32_t Fixed32(int number) { return Varint(number) | 5; }

enum class Field { kRead, kUnknown, kBroken };

// Reads the fields of a message inside another; `read(tag)` reads the value of one field.
template <typename ReadField>
Field ReadFields(CodedInputStream* input, const ReadField& read) {
  int length = 0;
  if (!input->ReadVarintSizeAsInt(&length)) return Field::kBroken;
  const auto limit = input->PushLimit(length);
  while (const std::uint32_t tag = input->ReadTag()) {
    const Field field = read(tag);
    if (field == Field::kBroken) return Field::kBroken;
    if (field == Field::kUnknown && !Wire::SkipField(input, tag)) return Field::kBroken;
  }
  const bool whole = input->ConsumedEntireMessage() && input->BytesUntilLimit() == 0;
  input->PopLimit(limit);
  return whole ? Field::kRead : Field::kBroken;
}

template <typename T, Wire::FieldType kType>
Field ReadValue(CodedInputStream* input, T* value) {
  return Wire::ReadPrimitive<T, kType>(input, value) ? Field::kRead : Field::kBroken;
}

Field ReadText(CodedInputStream* input, std::string* text) {
  int length = 0;
  const bool whole = input->ReadVarintSizeAsInt(&length) && input->ReadString(text, length);
  return whole ? Field::kRead : Field::kBroken;
}

// Room for the item's vertices.
float* AddVertices(std::size_t floats, FrameItems* items, FrameItems::Item* item) {
  item->vertices_begin = items->floats;
  item->vertices_end = items->floats += floats;
  if (items->vertices.size() < items->floats) items->vertices.resize(items->floats);
  return items->vertices.data() + item->vertices_begin;
}

Field ReadVertices(CodedInputStream* input, FrameItems* items, FrameItems::Item* item) {
  int bytes = 0;
  if (!input->ReadVarintSizeAsInt(&bytes) || bytes > input->BytesUntilLimit()) {
    return Field::kBroken;
  }
  const std::size_t floats = static_cast<std::size_t>(bytes) / sizeof(float);
  const bool whole =
      input->ReadRaw(AddVertices(floats, items, item), static_cast<int>(floats * sizeof(float))) &&
      input->Skip(bytes % static_cast<int>(sizeof(float)));
  return whole ? Field::kRead : Field::kBroken;
}

Field ReadSteps(CodedInputStream* input, FrameItems* items) {
  int bytes = 0;
  if (!input->ReadVarintSizeAsInt(&bytes) || bytes > input->BytesUntilLimit()) {
    return Field::kBroken;
  }
  const std::size_t count = static_cast<std::size_t>(bytes) / sizeof(std::int16_t);
  items->steps.resize(count);
  const bool whole =
      input->ReadRaw(items->steps.data(), static_cast<int>(count * sizeof(std::int16_t))) &&
      input->Skip(bytes % static_cast<int>(sizeof(std::int16_t)));
  return whole ? Field::kRead : Field::kBroken;
}

// Quantized vertices, as floats.
Field ReadQuantized(CodedInputStream* input, FrameItems* items, FrameItems::Item* item) {
  using Quantized = v1::QuantizedVertices;
  float center[2] = {0.0f, 0.0f}, step = 0.0f;
  items->steps.clear();
  const auto read_float = [&](float* value) {
    return ReadValue<float, Wire::TYPE_FLOAT>(input, value);
  };
  const Field read = ReadFields(input, [&](std::uint32_t tag) {
    switch (tag) {
      case Fixed32(Quantized::kCenterXFieldNumber):
        return read_float(&center[0]);
      case Fixed32(Quantized::kCenterYFieldNumber):
        return read_float(&center[1]);
      case Fixed32(Quantized::kStepFieldNumber):
        return read_float(&step);
      case Bytes(Quantized::kValuesFieldNumber):
        return ReadSteps(input, items);
      default:
        return Field::kUnknown;
    }
  });
  float* const vertices = AddVertices(items->steps.size(), items, item);
  for (std::size_t k = 0; k < items->steps.size(); ++k) {
    vertices[k] = center[k % 2] + step * static_cast<float>(items->steps[k]);
  }
  return read;
}

Field ReadNumbers(CodedInputStream* input, FrameItems* items, int* begin, int* end) {
  *begin = items->numbers.size();
  const bool whole = Wire::ReadPackedPrimitive<double, Wire::TYPE_DOUBLE>(input, &items->numbers);
  *end = items->numbers.size();
  return whole ? Field::kRead : Field::kBroken;
}

Field ReadFrame(CodedInputStream* input, FrameItems* items, FrameItems::Item* item) {
  return ReadFields(input, [&](std::uint32_t tag) {
    switch (tag) {
      case Bytes(v1::Frame::kVerticesFieldNumber):
        return ReadVertices(input, items, item);
      case Bytes(v1::Frame::kWeightsFieldNumber):
        return ReadNumbers(input, items, &item->weights_begin, &item->weights_end);
      case Bytes(v1::Frame::kTextureWeightsFieldNumber):
        return ReadNumbers(input, items, &item->textures_begin, &item->textures_end);
      case Varint(v1::Frame::kFoldsFieldNumber):
        return ReadValue<std::int32_t, Wire::TYPE_INT32>(input, &item->folds);
      case Varint(v1::Frame::kMendedFieldNumber):
        return ReadValue<std::int32_t, Wire::TYPE_INT32>(input, &item->mended);
      case Bytes(v1::Frame::kQuantizedFieldNumber):
        return ReadQuantized(input, items, item);
      default:
        return Field::kUnknown;
    }
  });
}

Field ReadItem(CodedInputStream* input, FrameItems* items) {
  using Result = v1::PlayResponse::ItemResult;
  FrameItems::Item& item = items->Add();
  return ReadFields(input, [&](std::uint32_t tag) {
    switch (tag) {
      case Varint(Result::kSlotFieldNumber):
        return ReadValue<std::uint32_t, Wire::TYPE_UINT32>(input, &item.slot);
      case Varint(Result::kTagFieldNumber):
        return ReadValue<std::uint32_t, Wire::TYPE_UINT32>(input, &item.tag);
      case Bytes(Result::kReasonFieldNumber):
        return ReadText(input, &item.reason);
      case Bytes(Result::kErrorMessageFieldNumber):
        return ReadText(input, &item.message);
      case Bytes(Result::kFrameFieldNumber):
        return ReadFrame(input, items, &item);
      case Varint(Result::kFadingFieldNumber):
        return ReadValue<bool, Wire::TYPE_BOOL>(input, &item.fading);
      default:
        return Field::kUnknown;
    }
  });
}

Field ReadResult(CodedInputStream* input, std::uint64_t* frame_id, FrameItems* items) {
  using Result = v1::PlayResponse::FrameResult;
  return ReadFields(input, [&](std::uint32_t tag) {
    switch (tag) {
      case Varint(Result::kFrameIdFieldNumber):
        return ReadValue<std::uint64_t, Wire::TYPE_UINT64>(input, frame_id);
      case Bytes(Result::kItemsFieldNumber):
        return ReadItem(input, items);
      default:
        return Field::kUnknown;
    }
  });
}

}  // namespace

FrameItems::Item& FrameItems::Add() {
  if (count == items.size()) items.emplace_back();
  Item& item = items[count++];
  item.slot = item.tag = 0;
  item.folds = item.mended = 0;
  item.vertices_begin = item.vertices_end = floats;
  item.weights_begin = item.weights_end = numbers.size();
  item.textures_begin = item.textures_end = numbers.size();
  item.fading = false;
  item.reason.clear();
  item.message.clear();
  return item;
}

void FrameItems::Clear() {
  count = 0;
  floats = 0;
  numbers.Clear();
}

ReadOutcome ReadFrameResult(ZeroCopyInputStream* message, std::uint64_t* frame_id,
                            FrameItems* items) {
  CodedInputStream input(message);
  if (input.ReadTag() != Bytes(v1::PlayResponse::kFrameResultFieldNumber)) {
    return ReadOutcome::kAnotherMessage;
  }
  *frame_id = 0;
  const bool whole = ReadResult(&input, frame_id, items) == Field::kRead && input.ReadTag() == 0;
  return whole ? ReadOutcome::kFrameResult : ReadOutcome::kBroken;
}

}  // namespace posespace::internal

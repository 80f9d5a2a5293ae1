// SPDX-License-Identifier: Apache-2.0
#include "rpc/play_tick.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "rpc/frame_result_writer.h"
#include "rpc/query_convert.h"
#include "rpc/shown_error.h"

namespace posespace {
namespace {

// What a thread needs for a tick, kept from one to the next; it only grows.
struct TickMemory {
  std::vector<ItemAnswer> answers;
  std::vector<Query> queries;
  std::vector<int> open;  // items that are still to be blended
  std::vector<int> together;
  std::vector<BlendJob> jobs;
  std::vector<double> weights, texture_weights, left_weights;
  std::vector<float> vertices;
  std::vector<float*> outs;  // where the vertices of each item go
};

template <typename T>
void GrowTo(std::size_t size, std::vector<T>* memory) {
  if (memory->size() < size) memory->resize(size);
}

class TickAnswerer {
 public:
  TickAnswerer(const v1::PlayRequest::Tick& tick, std::span<const TickItem> items,
               TickMemory* memory)
      : tick_(tick), items_(items), memory_(*memory) {
    GrowTo(items.size(), &memory_.answers);
    GrowTo(items.size(), &memory_.queries);
    GrowTo(items.size(), &memory_.outs);
    PlaceNumbers();
  }

  MessageBytes Answer() {
    memory_.open.clear();
    std::uint32_t superseded = 0;
    for (int k = 0; k < tick_.items_size(); ++k) {
      ItemAnswer& answer = memory_.answers[k];
      answer.slot = tick_.items(k).slot();
      answer.tag = tick_.items(k).tag();
      answer.reason.clear();
      answer.error_message.clear();
      superseded += items_[k].superseded;
      if (auto read = Read(k); read) {
        memory_.open.push_back(k);
      } else {
        Refuse(k, std::move(read).error());
      }
    }
    while (!memory_.open.empty()) {
      TakeTogether();
      const auto blended = Guarded([&]() -> Result<void> {
        Blend();
        return {};
      });
      if (blended) continue;
      for (const int k : memory_.together) Refuse(k, blended.error());
    }
    return WriteFrameResult(tick_.frame_id(), std::span(memory_.answers).first(items_.size()),
                            superseded, tick_.vertex_format());
  }

 private:
  // Where each item's numbers lie: fixed before any is written, since memory moves as it grows.
  void PlaceNumbers() {
    std::size_t floats = 0, weights = 0;
    for (const TickItem& item : items_) {
      if (item.pose_space == nullptr) continue;
      floats += FloatsOf(*item.pose_space);
      weights += PosesOf(*item.pose_space);
    }
    GrowTo(floats, &memory_.vertices);
    GrowTo(weights, &memory_.weights);
    if (tick_.with_weights()) GrowTo(weights, &memory_.texture_weights);
  }
  static std::size_t FloatsOf(const PoseSpace& pose_space) {
    return 2 * static_cast<std::size_t>(pose_space.mesh().num_vertices());
  }
  static std::size_t PosesOf(const PoseSpace& pose_space) {
    return static_cast<std::size_t>(pose_space.mesh().num_poses());
  }

  // What an item asks, and its weights.
  Result<void> Read(int k) {
    const v1::PlayRequest::Item& item = tick_.items(k);
    if (items_[k].superseded) {
      return Error{ErrorCode::kSuperseded, "a later frame asks for this item again", {}};
    }
    const PoseSpace* const pose_space = items_[k].pose_space;
    if (pose_space == nullptr) {
      const std::string name = std::to_string(item.slot());
      return Error{ErrorCode::kSlotNotBound, "slot " + name + " has no session", {}};
    }
    if (!v1::VertexFormat_IsValid(tick_.vertex_format())) {
      return ErrorAt(ErrorCode::kInvalidOption, "vertex_format",
                     "is " + std::to_string(tick_.vertex_format()) + ", which is not known here");
    }
    return Guarded([&]() -> Result<void> {
      auto outcome = ReadQuery(item.query(), *pose_space, k);
      if (!outcome) outcome.error().message.insert(0, "query: ");
      return outcome;
    });
  }

  Result<void> ReadQuery(const v1::Query& from, const PoseSpace& pose_space, int k) {
    Query& query = memory_.queries[k];
    TRY(QueryFromProto(from, &query));
    const std::size_t count = PosesOf(pose_space);
    const std::span<double> weights(memory_.weights.data() + used_weights_, count);
    TRY(pose_space.Weigh(query, weights));
    ItemAnswer& answer = memory_.answers[k];
    const Point* const at = std::get_if<Point>(&query.position);
    answer.fading = items_[k].fade != nullptr && at != nullptr;
    if (answer.fading) {
      GrowTo(count, &memory_.left_weights);
      items_[k].fade->Mix(*at, weights, std::span(memory_.left_weights).first(count));
    }
    answer.weights = weights;
    memory_.outs[k] = memory_.vertices.data() + used_floats_;
    answer.vertices = {memory_.outs[k], FloatsOf(pose_space)};
    answer.texture_weights = {};
    if (tick_.with_weights()) {
      const Eigen::VectorXd textures = pose_space.TextureWeightsOf(
          query, Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<int>(count)));
      double* const begin = memory_.texture_weights.data() + used_weights_;
      std::copy(textures.begin(), textures.end(), begin);
      answer.texture_weights = {begin, count};
    }
    used_weights_ += count;
    used_floats_ += answer.vertices.size();
    return {};
  }

  // Moves those open items that can be blended together with the first one.
  void TakeTogether() {
    const int first = memory_.open.front();
    memory_.together.clear();
    const auto stay = std::remove_if(memory_.open.begin(), memory_.open.end(), [&](int k) {
      const bool fits = items_[k].pose_space == items_[first].pose_space &&
                        memory_.queries[k].options == memory_.queries[first].options;
      if (fits) memory_.together.push_back(k);
      return fits;
    });
    memory_.open.erase(stay, memory_.open.end());
  }

  void Blend() {
    memory_.jobs.clear();
    for (const int k : memory_.together) {
      memory_.jobs.push_back({memory_.answers[k].weights, memory_.outs[k]});
    }
    const int first = memory_.together.front();
    items_[first].pose_space->Solve(memory_.jobs, memory_.queries[first].options);
    for (std::size_t j = 0; j < memory_.jobs.size(); ++j) {
      ItemAnswer& answer = memory_.answers[memory_.together[j]];
      answer.folds = memory_.jobs[j].folds;
      answer.mended = memory_.jobs[j].mended;
      if (!tick_.with_weights()) answer.weights = {};
    }
  }

  void Refuse(int k, Error error) {
    constexpr std::size_t kMessageBytes = 512;
    const Error shown = Shown(std::move(error));
    memory_.answers[k].reason = ReasonName(shown.code);
    memory_.answers[k].error_message = CleanText(shown.message, kMessageBytes);
  }

  const v1::PlayRequest::Tick& tick_;
  const std::span<const TickItem> items_;
  TickMemory& memory_;
  std::size_t used_floats_ = 0;
  std::size_t used_weights_ = 0;
};

}  // namespace

MessageBytes AnswerTick(const v1::PlayRequest::Tick& tick, std::span<const TickItem> items) {
  thread_local TickMemory memory;
  return TickAnswerer(tick, items, &memory).Answer();
}

}  // namespace posespace

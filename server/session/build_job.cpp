// SPDX-License-Identifier: Apache-2.0
#include "session/build_job.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

namespace posespace {
namespace {

using Clock = std::chrono::steady_clock;

// Reports of progress in quicker succession than this are merged.
constexpr std::chrono::milliseconds kReportInterval{20};

// Calls `overdue` from a thread of its own unless it is destroyed before `time`.
class Watchdog {
 public:
  Watchdog(Clock::time_point time, std::function<void()> overdue)
      : thread_([this, time, overdue = std::move(overdue)](const std::stop_token& stop) {
          std::unique_lock lock(mutex_);
          wakeup_.wait_until(lock, stop, time, [] { return false; });
          if (!stop.stop_requested()) overdue();
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any wakeup_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace

// Lock order: `calling` before `mutex`; neither is held while `done` runs, and only `calling` while
// listeners do.
struct BuildJob::State {
  enum class Phase { kWaiting, kBuilding, kEnding, kEnded };

  State(std::string id, std::string revision_of_inputs, std::shared_ptr<ChangeCounter> counter)
      : revision(std::move(revision_of_inputs)),
        changes(counter != nullptr ? std::move(counter) : std::make_shared<ChangeCounter>(0)) {
    status.id = std::move(id);
    status.sequence = ++*changes;
  }

  const std::string revision;
  const std::shared_ptr<ChangeCounter> changes;
  BuildInputs inputs;                      // read by the thread that builds, dropped at the end
  std::shared_ptr<const PoseSpace> reuse;  // the same
  Progress progress{[this](std::string_view stage, double f) { OnProgress(stage, f); }};
  Clock::time_point last_report;  // used by the thread that builds

  std::mutex calling;                     // serialises calls of listeners
  std::atomic<std::thread::id> caller{};  // who holds `calling`

  mutable std::mutex mutex;
  Phase phase = Phase::kWaiting;                                      // guarded by mutex
  bool cancelled = false;                                             // guarded by mutex
  BuildStatus status;                                                 // guarded by mutex
  std::map<std::int64_t, std::shared_ptr<const Listener>> listeners;  // guarded by mutex
  std::int64_t last_token = 0;                                        // guarded by mutex
  Done done;                                                          // guarded by mutex

  // Who calls listeners, for as long as this lives.
  class Calling {
   public:
    explicit Calling(State& state) : state_(state), lock_(state.calling) {
      state_.caller = std::this_thread::get_id();
    }
    ~Calling() { state_.caller = std::thread::id(); }
    Calling(const Calling&) = delete;
    Calling& operator=(const Calling&) = delete;

   private:
    State& state_;
    std::lock_guard<std::mutex> lock_;
  };

  // Changes the status and tells the listeners.
  template <typename Update>
  void Change(Update update) {
    const Calling calling_now(*this);
    BuildStatus copy;
    {
      const std::lock_guard lock(mutex);
      update(status);
      status.sequence = ++*changes;
      copy = status;
    }
    // One by one, since a listener may end its own or another's watch.
    for (std::int64_t token = 0;;) {
      std::shared_ptr<const Listener> listener;
      {
        const std::lock_guard lock(mutex);
        const auto next = listeners.upper_bound(token);
        if (next == listeners.end()) break;
        token = next->first;
        listener = next->second;
      }
      (*listener)(copy);
    }
  }

  void OnProgress(std::string_view stage, double fraction) {
    const auto now = Clock::now();
    {
      const std::lock_guard lock(mutex);
      if (status.stage == stage && now - last_report < kReportInterval) return;
    }
    last_report = now;
    Change([&](BuildStatus& current) {
      current.stage = stage;
      current.fraction = std::max(current.fraction, fraction);
    });
  }

  Result<std::shared_ptr<const PoseSpace>> Build(Clock::time_point deadline) {
    try {
      const Watchdog watchdog(deadline, [this] { progress.Cancel(); });
      if (reuse != nullptr && reuse->mesh_digest() == MeshDigest(inputs)) {
        return reuse->WithPlacements(inputs.placements, &progress);
      }
      return PoseSpace::Build(inputs, &progress);
    } catch (const std::exception& exception) {
      return Error{
          ErrorCode::kInternal, std::string("the build broke off: ") + exception.what(), {}};
    }
  }

  // Ends the job with a pose space or an error; whoever set phase kEnding calls it, once.
  void End(Result<std::shared_ptr<const PoseSpace>> result) {
    BuildStatus ended = [&] {
      const std::lock_guard lock(mutex);
      return status;
    }();
    const auto set = [&ended](Result<std::shared_ptr<const PoseSpace>> outcome) {
      ended.pose_space = outcome ? *outcome : nullptr;
      ended.summary =
          outcome ? std::make_shared<const BuildSummary>((*outcome)->Summary()) : nullptr;
      ended.error.reset();
      ended.state = BuildState::kSucceeded;
      if (outcome) {
        ended.fraction = 1.0;
        return;
      }
      ended.state = outcome.error().code == ErrorCode::kCancelled ? BuildState::kCancelled
                                                                  : BuildState::kFailed;
      ended.error = std::move(outcome).error();
    };
    set(std::move(result));

    const Done tell = [&] {
      const std::lock_guard lock(mutex);
      return std::exchange(done, nullptr);
    }();
    try {
      if (tell) {
        if (Result<void> taken = tell(ended); !taken) set(std::move(taken).error());
      }
    } catch (const std::exception& exception) {
      set(Error{ErrorCode::kInternal,
                std::string("the built pose space could not be used: ") + exception.what(),
                {}});
    }
    inputs = {};
    reuse = nullptr;
    Change([&](BuildStatus& current) {
      current = std::move(ended);
      phase = Phase::kEnded;
    });
  }
};

BuildJob::BuildJob(std::string id, BuildInputs inputs, Done done,
                   std::shared_ptr<const PoseSpace> reuse, std::shared_ptr<ChangeCounter> changes)
    : state_(std::make_unique<State>(std::move(id), RevisionDigest(inputs), std::move(changes))) {
  state_->inputs = std::move(inputs);
  state_->reuse = std::move(reuse);
  state_->done = std::move(done);
}

BuildJob::BuildJob(std::string id, std::shared_ptr<const PoseSpace> built,
                   std::shared_ptr<ChangeCounter> changes)
    : state_(std::make_unique<State>(std::move(id), built->revision(), std::move(changes))) {
  state_->phase = State::Phase::kEnded;
  state_->status.state = BuildState::kSucceeded;
  state_->status.fraction = 1.0;
  state_->status.summary = std::make_shared<const BuildSummary>(built->Summary());
  state_->status.pose_space = std::move(built);
}

BuildJob::~BuildJob() = default;

const std::string& BuildJob::revision() const { return state_->revision; }

BuildStatus BuildJob::Status() const {
  const std::lock_guard lock(state_->mutex);
  return state_->status;
}

bool BuildJob::ended() const {
  const std::lock_guard lock(state_->mutex);
  return state_->phase == State::Phase::kEnded;
}

bool BuildJob::cancelled() const {
  const std::lock_guard lock(state_->mutex);
  return state_->cancelled;
}

std::int64_t BuildJob::Watch(Listener listener) {
  const auto shared = std::make_shared<const Listener>(std::move(listener));
  const State::Calling calling_now(*state_);
  std::int64_t token = 0;
  BuildStatus copy;
  {
    const std::lock_guard lock(state_->mutex);
    token = ++state_->last_token;
    state_->listeners.emplace(token, shared);
    copy = state_->status;
  }
  (*shared)(copy);
  return token;
}

void BuildJob::Unwatch(std::int64_t token) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->listeners.erase(token);
  }
  if (state_->caller.load() == std::this_thread::get_id()) return;
  const std::lock_guard wait_for_running_call(state_->calling);
}

void BuildJob::Cancel() {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->phase == State::Phase::kBuilding) {
      state_->cancelled = true;
      state_->progress.Cancel();
    }
    if (state_->phase != State::Phase::kWaiting) return;
    state_->cancelled = true;
    state_->phase = State::Phase::kEnding;
  }
  state_->End(Error{ErrorCode::kCancelled, "the build was cancelled", {}});
}

void BuildJob::Run(std::chrono::milliseconds timeout) {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->phase != State::Phase::kWaiting) return;
    state_->phase = State::Phase::kBuilding;
  }
  state_->Change([](BuildStatus& status) { status.state = BuildState::kRunning; });

  const auto deadline = Clock::now() + timeout;
  auto result = state_->Build(deadline);

  bool cancelled = false;
  {
    const std::lock_guard lock(state_->mutex);
    cancelled = state_->cancelled;
    state_->phase = State::Phase::kEnding;
  }
  if (cancelled) {
    result = Error{ErrorCode::kCancelled, "the build was cancelled", {}};
  } else if (Clock::now() >= deadline && (result || result.error().code == ErrorCode::kCancelled)) {
    result = Error{
        ErrorCode::kBuildTimeout,
        "the build took longer than the limit of " + std::to_string(timeout.count() / 1000) + " s",
        {}};
  }
  state_->End(std::move(result));
}

}  // namespace posespace

// SPDX-License-Identifier: Apache-2.0
// How fast Play is beside an echo of the same bytes: see tests/bench/README.md.

#include <grpcpp/support/slice.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "interpolation/batch_blend.h"
#include "interpolation/pose_weights.h"
#include "ops/logging.h"
#include "posespace/v1/pose_service.pb.h"
#include "rpc/server.h"
#include "tests/bench/bench_session.h"
#include "tests/bench/echo_server.h"
#include "tests/bench/stream_load.h"

namespace posespace {
namespace {

constexpr char kSession[] = "bench";
constexpr int kDefaultRefits = BlendOptions().refits;
constexpr double kHertz = 60.0;

// A server in a process of its own, so that its CPU time is its own, too.  To be started before
// this process uses gRPC.
class ServerProcess {
 public:
  // `start` makes a pointer to a server that has an address().
  template <typename Start>
  explicit ServerProcess(const Start& start) {
    int address[2];
    if (pipe(address) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      const auto server = start();
      const std::string line = server->address() + "\n";
      if (write(address[1], line.data(), line.size()) < 0) std::_Exit(1);
      for (;;) pause();
    }
    close(address[1]);
    for (char c; read(address[0], &c, 1) == 1 && c != '\n';) address_ += c;
    close(address[0]);
    if (address_.empty()) throw std::runtime_error("a server did not start");
  }
  ~ServerProcess() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  const std::string& address() const { return address_; }
  pid_t process() const { return process_; }

 private:
  pid_t process_ = 0;
  std::string address_;
};

grpc::ByteBuffer BytesOf(const std::string& text) {
  const grpc::Slice slice(text);
  return {&slice, 1};
}

v1::PlayRequest RandomTick(int items, int refits, std::mt19937* random) {
  std::uniform_real_distribution<double> place(0.0, 1.0);
  v1::PlayRequest request;
  for (int k = 0; k < items; ++k) {
    v1::PlayRequest::Item& item = *request.mutable_tick()->add_items();
    item.set_tag(static_cast<std::uint32_t>(k));
    item.mutable_query()->mutable_at()->set_x(place(*random));
    item.mutable_query()->mutable_at()->set_y(place(*random));
    if (refits != kDefaultRefits) item.mutable_query()->mutable_options()->set_refits(refits);
  }
  return request;
}

// As Play answers a tick.
v1::PlayResponse AnswerTo(const v1::PlayRequest& request, int vertices) {
  v1::PlayResponse response;
  for (const auto& item : request.tick().items()) {
    auto& answer = *response.mutable_frame_result()->add_items();
    answer.set_tag(item.tag());
    answer.mutable_frame()->set_vertices(
        std::string(2 * sizeof(float) * static_cast<std::size_t>(vertices), 'v'));
  }
  return response;
}

// What the bench plays, and the same bytes as echo.
struct Bench {
  const ServerProcess& echo_server;
  const ServerProcess& play_server;
  CompatibleMesh mesh;
  BatchBlend blend;
  PoseWeights weights;

  LoadTarget Play(int items, int refits = 0) const {
    v1::PlayRequest bind;
    bind.mutable_bind()->set_session_id(kSession);
    return {play_server.address(), "/posespace.v1.PoseService/Play",
            play_server.process(), {BytesOf(bind.SerializeAsString())},
            /*first_answers=*/2,  // Welcome and Bound
            TicksOf(items, refits)};
  }
  // `busy`: seconds that each answer takes besides.
  LoadTarget Echo(int items, int refits = 0, double busy = 0.0) const {
    std::mt19937 random(1);
    const auto answer = AnswerTo(RandomTick(items, refits, &random), mesh.num_vertices());
    return {echo_server.address(), "/bench/Echo/" + std::to_string(std::lround(1e9 * busy)),
            echo_server.process(), {BytesOf(answer.SerializeAsString())},
            /*first_answers=*/0,   TicksOf(items, refits)};
  }
  static std::vector<grpc::ByteBuffer> TicksOf(int items, int refits) {
    std::mt19937 random(1);
    std::vector<grpc::ByteBuffer> ticks;
    for (int k = 0; k < 16; ++k) {
      ticks.push_back(BytesOf(RandomTick(items, refits, &random).SerializeAsString()));
    }
    return ticks;
  }

  // Seconds that weighing and blending one of `items` together take: the least of many tries.
  double BlendSeconds(int items, int refits) const {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(0.0, 1.0);
    FloatPoints out(items * mesh.num_vertices(), 2);
    std::vector<Eigen::VectorXd> found(items);
    double least = 1e9;
    for (int turn = 0; turn < 200; ++turn) {
      const auto start = std::chrono::steady_clock::now();
      std::vector<BlendJob> jobs;
      for (int k = 0; k < items; ++k) {
        found[k] = weights.At({place(random), place(random)});
        jobs.push_back(
            {{found[k].data(), kBenchPlaces.size()}, out.row(k * mesh.num_vertices()).data()});
      }
      blend.Solve(jobs, {.refits = refits});
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      least = std::min(least, took.count() / items);
    }
    return least;
  }
};

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

void PrintRatio(const char* name, double value) {
  if (!std::isfinite(value)) throw std::runtime_error(std::string(name) + " cannot be measured");
  std::printf("ratio %s %.3f\n", name, value);
  std::fflush(stdout);
}

struct Effort {
  int rounds;
  double seconds;  // of a measurement
  bool whole_grid;
};

// Play over echo, medians over rounds in which both take turns.
struct Comparison {
  double p50, p99, cpu;  // Play over echo and blend
  double play_rate;      // messages a second
};

Comparison Compare(const Bench& bench, const Effort& effort, int streams, int items, double hertz,
                   int refits) {
  const double blend = items * bench.BlendSeconds(items, refits);
  const LoadTarget echo_target = bench.Echo(items, refits), play_target = bench.Play(items, refits);
  const LoadPlan plan{streams, hertz, effort.seconds};
  std::array<std::vector<double>, 11> found;
  for (int round = 0; round < effort.rounds; ++round) {
    const LoadResult echo = Load(echo_target, plan), play = Load(play_target, plan);
    const std::array<double, 11> now = {play.p50 / (echo.p50 + blend),
                                        play.p99 / (echo.p99 + blend),
                                        play.server_seconds / (echo.server_seconds + blend),
                                        echo.p50,
                                        echo.p99,
                                        play.p50,
                                        play.p99,
                                        echo.messages_per_second,
                                        play.messages_per_second,
                                        echo.server_seconds,
                                        play.server_seconds};
    for (std::size_t k = 0; k < now.size(); ++k) found[k].push_back(now[k]);
  }
  std::array<double, 11> m;
  for (std::size_t k = 0; k < m.size(); ++k) m[k] = Median(found[k]);
  std::printf(
      "%-6s %3d x %2d, %d refits  echo %7.0f/%7.0f us %6.0f/s %6.2f us CPU   Play %7.0f/%7.0f us "
      "%6.0f/s %6.2f us CPU   blend %5.2f us   p50 %.2f p99 %.2f CPU %.2f\n",
      hertz > 0.0 ? "60 Hz" : "closed", streams, items, refits, 1e6 * m[3], 1e6 * m[4], m[7],
      1e6 * m[9] / items, 1e6 * m[5], 1e6 * m[6], m[8], 1e6 * m[10] / items, 1e6 * blend / items,
      m[0], m[1], m[2]);
  std::fflush(stdout);
  return {m[0], m[1], m[2], m[8]};
}

// Play over an echo that takes as long as the blends, with streams that never pause: what Play adds
// where a message waits for those of others, which `Compare` counts against it.
struct BusyComparison {
  double p50, p99, cpu;
};

BusyComparison CompareWithBusyEcho(const Bench& bench, const Effort& effort, int streams,
                                   int items) {
  const LoadTarget echo_target = bench.Echo(items, 0, items * bench.BlendSeconds(items, 0));
  const LoadTarget play_target = bench.Play(items);
  std::vector<double> p50, p99, cpu;
  for (int round = 0; round < effort.rounds; ++round) {
    const LoadPlan plan{streams, 0.0, effort.seconds};
    const LoadResult echo = Load(echo_target, plan), play = Load(play_target, plan);
    p50.push_back(play.p50 / echo.p50);
    p99.push_back(play.p99 / echo.p99);
    cpu.push_back(play.server_seconds / echo.server_seconds);
    std::printf("closed %3d x %2d  busy echo %7.0f/%7.0f us   Play %7.0f/%7.0f us\n", streams,
                items, 1e6 * echo.p50, 1e6 * echo.p99, 1e6 * play.p50, 1e6 * play.p99);
  }
  return {Median(p50), Median(p99), Median(cpu)};
}

// Two threads of the lowest priority that do nothing but run: what any work at a build's priority
// costs others on this machine.
class Spinners {
 public:
  Spinners() {
    for (std::jthread& thread : threads_) {
      thread = std::jthread([](const std::stop_token& stop) {
        setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 19);
        while (!stop.stop_requested()) {
        }
      });
    }
  }

 private:
  std::array<std::jthread, 2> threads_;
};

// Frames that are not there by the next, of `streams` streams of 64 avatars.
double Dropped(const Bench& bench, const Effort& effort, int streams, int refits) {
  std::vector<double> dropped;
  const LoadTarget target = bench.Play(64, refits);
  for (int round = 0; round < effort.rounds; ++round) {
    const LoadResult load = Load(target, {streams, kHertz, std::min(1.0, 3.0 * effort.seconds)});
    std::printf("60 Hz  %3d x 64, %d refits  Play %7.0f/%7.0f us, %ld of %ld frames dropped\n",
                streams, refits, 1e6 * load.p50, 1e6 * load.p99, load.dropped, load.messages);
    dropped.push_back(static_cast<double>(load.dropped));
  }
  return Median(dropped);
}

void CompareWithBuilds(const Bench& bench, const Effort& effort) {
  const LoadTarget sixteen = bench.Play(16, 0);
  const LoadPlan plan{16, kHertz, 2.0 * effort.seconds};
  std::vector<double> slower, late, late_beside_spinners;
  for (int round = 0; round < effort.rounds; ++round) {
    const LoadResult quiet = Load(sixteen, plan);
    const LoadResult spun = [&] {
      const Spinners spinners;
      return Load(sixteen, plan);
    }();
    const BusyBuilds builds(bench.play_server.address(), 2);
    const LoadResult busy = Load(sixteen, plan);
    std::printf(
        "16 x 16, 60 Hz  alone %.0f/%.0f us, two spinners %.0f/%.0f us, two builds "
        "%.0f/%.0f us\n",
        1e6 * quiet.p50, 1e6 * quiet.p99, 1e6 * spun.p50, 1e6 * spun.p99, 1e6 * busy.p50,
        1e6 * busy.p99);
    slower.push_back(busy.p50 / quiet.p50);
    late.push_back(busy.p99 / quiet.p99);
    late_beside_spinners.push_back(spun.p99 / quiet.p99);
  }
  PrintRatio("play.p50_under_build", Median(slower));
  PrintRatio("play.p99_under_build", Median(late));
  PrintRatio("play.p99_under_spinners", Median(late_beside_spinners));
}

void Run(const Bench& bench, const Effort& effort) {
  const std::vector<int> stream_counts =
      effort.whole_grid ? std::vector{1, 64, 256} : std::vector{1, 64};
  const std::vector<int> item_counts =
      effort.whole_grid ? std::vector{1, 16, 64} : std::vector{1, 64};
  double p50 = 0.0, p99 = 0.0, cpu = 0.0, one = 0.0, sixty_four = 0.0;
  for (const double hertz : {0.0, kHertz}) {
    for (const int streams : stream_counts) {
      for (const int items : item_counts) {
        const Comparison c = Compare(bench, effort, streams, items, hertz, 0);
        if (hertz == 0.0 && streams == 64) {
          if (items == 1) one = c.play_rate;
          if (items == 64) sixty_four = 64.0 * c.play_rate;
          cpu = std::max(cpu, c.cpu);
        }
        if (streams > 64 || items == 16) continue;
        p50 = std::max(p50, c.p50);
        p99 = std::max(p99, c.p99);
      }
    }
  }
  PrintRatio("play.p50_vs_echo", p50);
  PrintRatio("play.p99_vs_echo", p99);
  PrintRatio("play.cpu_per_item_vs_echo", cpu);
  PrintRatio("play.batch64_vs_1", sixty_four / one);

  BusyComparison busiest{};
  for (const int items : {1, 64}) {
    const BusyComparison c = CompareWithBusyEcho(bench, effort, 64, items);
    busiest = {std::max(busiest.p50, c.p50), std::max(busiest.p99, c.p99),
               std::max(busiest.cpu, c.cpu)};
  }
  PrintRatio("play.p50_vs_busy_echo", busiest.p50);
  PrintRatio("play.p99_vs_busy_echo", busiest.p99);
  PrintRatio("play.cpu_per_item_vs_busy_echo", busiest.cpu);

  CompareWithBuilds(bench, effort);
  PrintRatio("play.idle_first_ms",
             1e3 * FirstAfterIdle(bench.Play(1, 0), 1.05, std::min(3, effort.rounds)));
  PrintRatio("play.dropped_2048x60", Dropped(bench, effort, 32, 0));
  PrintRatio("play.dropped_1024x60_refit", Dropped(bench, effort, 16, kDefaultRefits));
}

}  // namespace
}  // namespace posespace

int main(int argc, char** argv) {
  using namespace posespace;
  Effort effort{5, 1.0, true};
  if (argc == 2 && std::strcmp(argv[1], "--quick") == 0) {
    effort = {5, 0.18, false};
  } else if (argc == 2 && std::strcmp(argv[1], "--smoke") == 0) {
    effort = {1, 0.1, false};
  } else if (argc > 1) {
    std::fprintf(stderr, "usage: play_bench [--quick | --smoke]\n");
    return 2;
  }
  SetUpLogging("error");
  try {
    const ServerProcess echo([] { return std::make_unique<EchoServer>(); });
    const ServerProcess play([] { return Server::Start("127.0.0.1:0", Limits()).value(); });
    CompatibleMesh mesh = BuildStars(play.address(), kSession, 100, 0.11);
    Points places(static_cast<Eigen::Index>(kBenchPlaces.size()), 2);
    for (std::size_t k = 0; k < kBenchPlaces.size(); ++k) places.row(k) = kBenchPlaces[k];
    auto blend = BatchBlend::Prepare(mesh).value();
    auto weights = PoseWeights::Fit(places).value();
    std::printf("mesh of %d vertices and %zu poses\n", mesh.num_vertices(), mesh.poses.size());
    Run({echo, play, std::move(mesh), std::move(blend), std::move(weights)}, effort);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "play_bench: %s\n", failure.what());
    return 1;
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// An avatar server in small: avatars on paths through pose space, all asked for in one tick, at a
// steady rate; prints what it measured.
//
//   avatar_server ADDRESS [AVATARS [HZ [SECONDS]]]
#include <posespace/client.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

// A round creature with five limbs; `reach` is how far they go out, `turn` where they point.
posespace::PolygonSource Creature(double reach, double turn) {
  posespace::PolygonSource drawing;
  for (int k = 0; k < 120; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 120;
    const double radius = 60.0 + reach * std::max(0.0, std::cos(5.0 * (angle - turn)));
    drawing.outer.push_back({150.0 + radius * std::cos(angle), 150.0 + radius * std::sin(angle)});
  }
  return drawing;
}

posespace::Session BuildCreature(const posespace::Client& client) {
  posespace::Session session = client.CreateSession();
  session.PutShape("rest", Creature(25.0, 0.0));
  session.PutShape("stretch", Creature(70.0, 0.0));
  session.PutShape("left", Creature(45.0, -0.25));
  session.PutShape("right", Creature(45.0, 0.25));
  session.SetPlacements(
      {{"rest", {0, 0}}, {"stretch", {0, 1}}, {"left", {-1, 0.5}}, {"right", {1, 0.5}}});
  session.Build({.target_edge_length = 0.25});  // coarse: avatars are small on the screen
  return session;
}

// Where an avatar is at a time, seconds: each walks an ellipse of its own through pose space.
posespace::Point PlaceOf(std::uint32_t avatar, double time) {
  const double phase = 0.7 * avatar, speed = 0.5 + 0.001 * (avatar % 1'000);
  return {0.8 * std::sin(speed * time + phase), 0.5 + 0.4 * std::cos(1.3 * speed * time + phase)};
}

double Quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: avatar_server ADDRESS [AVATARS [HZ [SECONDS]]]\n");
    return 2;
  }
  const auto avatars = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 500);
  const double hz = argc > 3 ? std::atof(argv[3]) : 60.0;
  const double seconds = argc > 4 ? std::atof(argv[4]) : 5.0;

  const posespace::Client client(argv[1]);
  posespace::Session session = BuildCreature(client);
  posespace::Player player = session.Play();  // the session is slot 0

  std::vector<double> latencies;  // from asking to the last answer, milliseconds
  std::size_t bytes = 0;
  int late = 0, refused = 0;
  const int ticks = static_cast<int>(hz * seconds);
  const auto start = Clock::now();
  for (int tick = 0; tick < ticks; ++tick) {
    const auto due = start + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(tick / hz));
    std::this_thread::sleep_until(due);
    const auto asked = Clock::now();
    for (std::uint32_t avatar = 0; avatar < avatars; ++avatar) {
      player.Ask(0, avatar, PlaceOf(avatar, tick / hz));
    }
    for (const posespace::Answer& answer : player.Tick()) {
      if (answer.error != nullptr) ++refused;
      bytes +=
          answer.vertices.size_bytes();  // here a real one sends them to whoever sees the avatar
    }
    const auto answered = Clock::now();
    latencies.push_back(std::chrono::duration<double, std::milli>(answered - asked).count());
    late += std::chrono::duration<double>(answered - due).count() > 1.0 / hz;
  }

  std::printf("%u avatars at %g Hz: %d ticks, %d late, %d refused\n", avatars, hz, ticks, late,
              refused);
  std::printf("latency p50 %.2f ms, p99 %.2f ms; %.1f kB of vertices a tick\n",
              Quantile(latencies, 0.5), Quantile(latencies, 0.99),
              ticks > 0 ? static_cast<double>(bytes) / ticks / 1e3 : 0.0);
  session.Delete();
  return refused == 0 ? 0 : 1;
} catch (const posespace::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

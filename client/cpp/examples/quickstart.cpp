// SPDX-License-Identifier: Apache-2.0
// Two drawings, and a second of what lies between them:  quickstart [ADDRESS]
#include <posespace/client.h>

#include <iostream>

int main(int argc, char** argv) try {
  posespace::Client client(argc > 1 ? argv[1] : "127.0.0.1:7433");
  posespace::Session session = client.CreateSession("tux");
  session.PutShape("stand", posespace::ImageSource{posespace::ReadFile("stand.png")});
  session.PutShape("jump", posespace::ImageSource{posespace::ReadFile("jump.png")});
  session.SetPlacements({{"stand", {0, 0}}, {"jump", {0, 1}}});
  session.Build();
  posespace::Frame frame = session.Blend({0.0, 0.5});  // frame.vertices: x0 y0 x1 y1 ..., y down
  std::cout << frame.vertices.size() / 2 << " vertices\n";

  posespace::Player player = session.Play();  // the stream: many avatars a tick, answers in order
  for (int tick = 0; tick < 60; ++tick) {
    for (int avatar = 0; avatar < 3; ++avatar) player.Ask(0, avatar, {0.0, tick / 60.0});
    for (const posespace::Answer& answer : player.Tick()) {
      std::cout << answer.tag << ": " << answer.vertices[0] << ' ' << answer.vertices[1] << '\n';
    }
  }
} catch (const posespace::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}

// SPDX-License-Identifier: Apache-2.0
// Does through the C++ client what test_parity.py does through the Python client, and says what
// came out:  client_parity ADDRESS FOLDER
//
// FOLDER has drawings a.png, b.png and c.png.  Writes the vertices of all blends to FOLDER/frames,
// those of the stream to FOLDER/played, the weights to FOLDER/weights; prints the revisions.
#include <fstream>
#include <iostream>
#include <span>
#include <vector>

#include "posespace/client.h"

namespace {

template <typename T>
void Write(std::ofstream& file, std::span<const T> values) {
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size_bytes()));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return 2;
  const posespace::Client client(argv[1], {.timeout = std::chrono::seconds(30)});
  const std::string folder = argv[2];

  posespace::Session session = client.CreateSession();
  for (const std::string id : {"a", "b", "c"}) {
    session.PutShape(id, posespace::ImageSource{posespace::ReadFile(folder + "/" + id + ".png")});
  }
  session.SetCorrespondences({{{"a", {100, 18}}, {"b", {100, 18}}, {"c", {100, 18}}}});
  session.SetPlacements({{"a", {0, 0}}, {"b", {1, 0.2}}, {"c", {0.4, 1}}});
  session.Build({.tolerance = 0.02, .target_edge_length = 0.1});

  std::vector<posespace::Point> points;
  for (int k = 0; k < 300; ++k) points.push_back({-0.5 + k / 150.0, 1.5 - k / 100.0});

  std::ofstream frames(folder + "/frames", std::ios::binary);
  Write<float>(frames, session.BlendMany(points).vertices);
  Write<float>(frames, session.Blend(posespace::Weights{{"a", 1.5}, {"c", -0.5}}).vertices);
  Write<float>(frames, session
                           .Blend({0.3, 0.3}, {.method = posespace::BlendMethod::kPaper,
                                               .shear_limit = posespace::ShearLimit::kOff})
                           .vertices);

  std::ofstream played(folder + "/played", std::ios::binary);
  posespace::Player player = session.Play();
  for (std::uint32_t k = 0; k < points.size(); ++k) player.Ask(0, k, points[k]);
  for (const posespace::Answer& answer : player.Tick()) Write<float>(played, answer.vertices);

  std::ofstream weights(folder + "/weights", std::ios::binary);
  Write<double>(weights, session.Weights(points).values);

  posespace::Session only = client.CreateSession();
  only.PutShape("a", posespace::ImageSource{posespace::ReadFile(folder + "/a.png")});
  only.Build();
  Write<float>(frames, only.Blend({2, 3}).vertices);
  std::cout << session.State().revision << ' ' << only.State().revision << '\n';
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}

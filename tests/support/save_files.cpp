// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// save_files FOLDER VERSION: saves a model, a file and a recording, for tests that interrupt it.
#include <iostream>
#include <string>

#include "camera/oni_file.hpp"
#include "core/base/failure.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"

namespace {

void record(const std::string& path) {
  bpa::camera::OniStreamFormat depth;
  depth.width = 4;
  depth.height = 3;
  depth.frame_bytes = 24;
  auto writer = bpa::or_throw(bpa::camera::OniWriter::create(path, {depth}, true));
  const std::string frame(depth.frame_bytes, '\1');
  for (int i = 0; i < 3; ++i) {
    bpa::or_throw(writer.add(0, 33'000 * i, frame.data(), frame.size()));
  }
  bpa::or_throw(writer.finish());
}

}  // namespace

int main(int, char** argv) {
  const std::string folder = argv[1], version = argv[2];
  try {
    bpa::or_throw(bpa::io::write_file(folder + "/settings", "version " + version));
    record(folder + "/" + version + ".oni");
    const float size = version == "1" ? 0.05F : 0.06F;
    auto model = bpa::or_throw(
        bpa::modeling::model_source_from_mesh(bpa::test::box_mesh({size, 0.02F, 0.03F}), "box", 1));
    bpa::or_throw(bpa::io::save_model(folder + "/library", model));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}

// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/file_bytes.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

namespace fs = std::filesystem;

TEST(FileBytes, WhatCannotBeLookedAtIsNotThere) {
  const test::TemporaryFolder folder;
  test::spill(folder / "a", "x");
  EXPECT_TRUE(is_file(folder / "a"));
  EXPECT_FALSE(is_folder(folder / "a"));
  EXPECT_TRUE(is_folder(folder.path()));
  for (const std::string& path :
       {std::string(300, 'm'), std::string(5000, 'm'), folder / "a/b", std::string()}) {
    EXPECT_FALSE(is_file(path));
    EXPECT_FALSE(is_folder(path));
    EXPECT_FALSE(read_file(path).ok());
  }
}

TEST(PathBelow, StaysInTheFolder) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "root/deep");
  fs::create_directory(folder / "outside");
  fs::create_directory_symlink(folder / "outside", folder / "root/link");
  fs::create_symlink(folder / "outside/new", folder / "root/dangling");
  fs::create_directory_symlink(folder / "root", folder / "alias");
  const std::string root = fs::canonical(folder / "root");

  for (const auto& [path, below] : {std::pair<std::string, std::string>("a.oni", "/a.oni"),
                                    {"deep/a.oni", "/deep/a.oni"},
                                    {"./deep//a.oni", "/deep/a.oni"},
                                    {"deep/../a.oni", "/a.oni"},
                                    {"new/a.oni", "/new/a.oni"},
                                    {folder / "root/a.oni", "/a.oni"},
                                    {std::string(255, 'm'), "/" + std::string(255, 'm')}}) {
    const auto found = path_below(folder / "root", path);
    ASSERT_TRUE(found.ok()) << path << ": " << found.status().message;
    EXPECT_EQ(*found, root + below);
    EXPECT_EQ(path_below((folder / "root") + "/", path).value(), root + below);
  }
  EXPECT_EQ(path_below(folder / "alias", folder / "alias/a").value(), root + "/a");

  for (const std::string& path :
       {std::string("../outside/a"), std::string("deep/../../outside/a"), folder / "outside/a",
        std::string("/etc/passwd"), std::string("/"), std::string(), std::string("."),
        std::string("deep/.."), folder / "root", folder / "rootless/a", std::string("link/a"),
        std::string("link"), std::string("dangling"), std::string("a\nb"), std::string("a\0b", 3),
        std::string("a\x1b[2Jb"), std::string(256, 'm'), std::string(5000, 'm')}) {
    const auto found = path_below(folder / "root", path);
    EXPECT_EQ(found.status().code, StatusCode::invalid_argument) << path;
  }
  EXPECT_EQ(path_below(folder / "none", "a").status().code, StatusCode::unavailable);
}

}  // namespace
}  // namespace bpa::io

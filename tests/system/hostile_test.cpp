// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"
#include "tests/support/stub_server.hpp"

// A real server that clients ask for what it must refuse: each gets its answer, the server goes on.

namespace bpa {
namespace {

/// bpa-server with a library of one model; another model lies elsewhere.
class Hostile : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto model =
        modeling::model_source_from_mesh(test::box_mesh({0.06f, 0.04f, 0.025f}), "brick", 1);
    ASSERT_TRUE(model.ok()) << model.status().message;
    ASSERT_TRUE(io::save_model(library(), *model).ok());
    model->name = "other";
    ASSERT_TRUE(io::save_model(elsewhere(), *model).ok());
  }
  static std::string library() { return support::scratch_folder() + "/hostile_library"; }
  static std::string elsewhere() { return support::scratch_folder() + "/elsewhere"; }

  void start(const std::vector<std::string>& settings) {
    std::vector<std::string> command = support::own_command("bpa-server", {"--library", library()});
    for (const std::string& setting : settings) {
      command.push_back("--set");
      command.push_back(setting);
    }
    server_ = std::make_unique<support::Process>(command, log_path_);
    auto made = Client::connect(support::client_options());
    ASSERT_TRUE(made.ok()) << made.status().message << log();
    client_.emplace(std::move(made).value());
  }
  Client& client() { return *client_; }
  std::string log() const { return support::read_text(log_path_); }

 private:
  const std::string log_path_ = support::scratch_folder() + "/hostile.log";
  std::unique_ptr<support::Process> server_;
  std::optional<Client> client_;
};

TEST_F(Hostile, ModelsThatCannotBeLookedAtAreRefused) {
  start({"detection.model_folder=" + elsewhere()});
  for (const std::string& source :
       {std::string(300, 'm'), "/" + std::string(300, 'm'), "/" + std::string(5000, 'm') + "/m",
        elsewhere() + "/" + std::string(300, 'm'), elsewhere() + "/none", std::string("/proc/1/m"),
        std::string("a\0b", 3), std::string()}) {
    const Status status = client().load_model(source);
    EXPECT_FALSE(status.ok()) << source;
    EXPECT_NE(status.code, StatusCode::timeout) << source;
    EXPECT_NE(status.code, StatusCode::internal) << source << ": " << status.message;
    EXPECT_FALSE(status.message.empty());
  }
  EXPECT_TRUE(client().status().ok()) << log();
}

TEST_F(Hostile, PathsOfModelsAreRefusedWithoutAFolder) {
  start({});
  const Status status = client().load_model(elsewhere() + "/other");
  EXPECT_EQ(status.code, StatusCode::unsupported);
  EXPECT_NE(status.message.find("detection.model_folder"), std::string::npos) << status.message;
  EXPECT_TRUE(client().load_model("brick", "another").ok());
}

TEST_F(Hostile, PathsOfModelsStayBelowTheFolder) {
  start({"detection.model_folder=" + elsewhere(), "detection.max_models=3"});
  std::filesystem::create_directory_symlink(library(), elsewhere() + "/link");
  for (const std::string& source : {library() + "/brick", elsewhere() + "/../brick",
                                    std::string("/etc/"), elsewhere() + "/link/brick"}) {
    const Status status = client().load_model(source);
    EXPECT_EQ(status.code, StatusCode::invalid_argument) << source << ": " << status.message;
  }
  for (const char* name : {"../../x", "a b", "a/b", "\x1b[2J", ".x", "a\nb"}) {
    const Status status = client().load_model("brick", name);
    EXPECT_EQ(status.code, StatusCode::invalid_argument) << name;
    EXPECT_NE(status.message.find("letters"), std::string::npos) << status.message;
  }
  EXPECT_TRUE(client().load_model(elsewhere() + "/other").ok());
  EXPECT_TRUE(client().load_model(elsewhere() + "/other/model.json", "third").ok());
  EXPECT_EQ(client().load_model("brick", "fourth").code, StatusCode::busy);
  EXPECT_TRUE(client().load_model("brick", "third").ok());  // replaces one
  const auto models = client().models();
  ASSERT_TRUE(models.ok()) << models.status().message;
  EXPECT_EQ(models->size(), 3U);
}

}  // namespace
}  // namespace bpa

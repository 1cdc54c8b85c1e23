// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>
#include <csignal>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include <bpa/client.hpp>

#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "core/pipeline/detector.hpp"
#include "idl/wire/service.hpp"
#include "server/convert/results.hpp"
#include "tests/support/box_frame.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"
#include "tests/support/stub_server.hpp"

// A front and workers as real processes. The answer is that of one detector with the whole library,
// whatever happens to workers: to the bit with one worker, the same objects with several.

namespace bpa {
namespace {

namespace msgs = wire::bpa_msgs;
using std::chrono::milliseconds;
using support::Process;

constexpr std::uint64_t kSeed = 5;
constexpr milliseconds kLong(90000);

class Group : public testing::Test {
 protected:
  Group() {
    int number = 0;
    save(support::stepped_box(), "step", ++number);
    save(test::box_mesh({0.03f, 0.045f, 0.02f}), "box", ++number);
    save(test::box_mesh({0.05f, 0.03f, 0.01f}), "plate", ++number);
    save(test::l_mesh(), "angle", ++number);
  }

  void save(const TriangleMesh& mesh, const std::string& name, int number) {
    const auto source = modeling::model_source_from_mesh(mesh, name, number);
    ASSERT_TRUE(source.ok()) << source.status().message;
    ASSERT_TRUE(io::save_model(library_, *source).ok());
  }

  /// What one detector finds.
  msgs::SceneInterpretations expected() {
    auto sources = io::load_library(library_);
    EXPECT_TRUE(sources.ok()) << sources.status().message;
    auto library = std::make_shared<ModelLibrary>();
    for (ModelSource& source : *sources) {
      auto model = make_object_model(std::move(source));
      EXPECT_TRUE(model.ok() && library->add(*model).ok());
    }
    DetectRequest request;
    request.seed = kSeed;
    const auto found = Detector(library, DetectorOptions()).detect(frame_, request);
    EXPECT_TRUE(found.ok()) << found.status().message;
    return server::interpretations_message(
        found, {frame_.stamp_ns, frame_.frame_id, library->size(), kSeed});
  }

  std::unique_ptr<Process> start(const std::string& role, const std::string& name,
                                 std::vector<std::string> arguments = {}) {
    std::vector<std::string> all = {"--role", role, "--threads", "1"};
    if (role == "front") all.insert(all.end(), {"--library", library_});
    if (role == "worker") all.insert(all.end(), {"--set", "group.cache=" + folder_ + "/cache"});
    all.insert(all.end(), arguments.begin(), arguments.end());
    return std::make_unique<Process>(support::own_command("bpa-server", all), log_of(name));
  }
  std::string log_of(const std::string& name) const { return folder_ + "/" + name + ".log"; }

  /// Until the front can use so many workers.
  void wait_for_workers(std::size_t count) {
    const auto end = std::chrono::steady_clock::now() + kLong;
    std::size_t ready = 0;
    while (ready != count && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(milliseconds(100));
      const auto status = call<msgs::GetStatus>("get_status", {});
      if (!status) continue;
      ready = 0;
      for (const auto& [key, value] : status->details) {
        ready += key.starts_with("worker ") && value.starts_with("ready");
      }
    }
    ASSERT_EQ(ready, count) << support::read_text(log_of("front"));
  }

  template <class Service>
  std::optional<typename Service::Response> call(const std::string& name,
                                                 const typename Service::Request& request,
                                                 milliseconds timeout = kLong) {
    if (!participant_) participant_.emplace(*support::test_participant("tester"));
    auto client = wire::ServiceClient<Service>::create(*participant_, name);
    EXPECT_TRUE(client.ok()) << client.status().message;
    auto response = client->call(request, timeout);
    if (!response.ok()) {
      failure_ = response.status();
      return std::nullopt;
    }
    return *std::move(response);
  }

  msgs::Detect_Request request() const {
    msgs::Detect_Request request;
    request.has_frame = true;
    request.frame = support::message_of(frame_);
    request.seed = kSeed;
    return request;
  }

  enum class As { same_bits, same_objects };

  void expect_answer(const msgs::SceneInterpretations& answer, As as = As::same_objects) {
    const auto reply = call<msgs::Detect>("detect", request());
    ASSERT_TRUE(reply) << failure_.message << support::read_text(log_of("front"));
    ASSERT_TRUE(reply->success) << reply->status.message << support::read_text(log_of("front"));
    EXPECT_EQ(reply->result.status.message, "");
    if (as == As::same_bits) {
      EXPECT_TRUE(support::bits(reply->result) == support::bits(answer))
          << support::read_text(log_of("front"));
    }
    const auto& found = reply->result.interpretations.at(0).placements;
    const auto& wanted = answer.interpretations.at(0).placements;
    ASSERT_FALSE(wanted.empty());
    ASSERT_EQ(found.size(), wanted.size()) << support::read_text(log_of("front"));
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_EQ(found[i].model, wanted[i].model);
      const auto &here = found[i].pose.pose.position, &there = wanted[i].pose.pose.position;
      EXPECT_LT(std::hypot(here.x - there.x, here.y - there.y, here.z - there.z), 0.003);
    }
  }

  const std::string folder_ = support::scratch_folder();
  const std::string library_ = folder_ + "/group_library";
  const Frame frame_ = support::box_frame();
  std::optional<wire::Participant> participant_;
  Status failure_;
};

TEST_F(Group, AnswersAsOneServerDoesAndTakesUpAChangedModel) {
  const auto front = start("front", "front");
  expect_answer(expected(), As::same_bits);  // alone
  const auto first = start("worker", "first");
  wait_for_workers(1);
  expect_answer(expected(), As::same_bits);
  const auto second = start("worker", "second");
  wait_for_workers(2);
  expect_answer(expected());
  save(test::sphere_mesh(0.02), "ball", 5);
  msgs::LoadModel_Request load;
  load.source = "ball";
  const auto loaded = call<msgs::LoadModel>("load_model", load);
  ASSERT_TRUE(loaded && loaded->success);
  const msgs::SceneInterpretations with_ball = expected();
  expect_answer(with_ball);  // whoever has it by now
  wait_for_workers(2);
  expect_answer(with_ball);
}

TEST_F(Group, AnswersAlthoughWorkersAreKilledOrStopped) {
  const auto front = start("front", "front");
  const msgs::SceneInterpretations answer = expected();
  const auto stays = start("worker", "stays");
  const std::pair<int, milliseconds> cases[] = {
      {SIGKILL, milliseconds(30)}, {SIGKILL, milliseconds(120)}, {SIGSTOP, milliseconds(60)}};
  for (const auto& [signal, after] : cases) {
    const auto goes = start("worker", "goes");
    wait_for_workers(2);
    std::jthread killer([&, number = signal, time = after] {
      std::this_thread::sleep_for(time);
      goes->signal(number);
    });
    expect_answer(answer);
  }
  wait_for_workers(1);
}

TEST_F(Group, SaysWhichModelsAStoppedWorkerLeftWhereTimeIsShort) {
  const auto front = start("front", "front");
  const auto first = start("worker", "first"), second = start("worker", "second");
  wait_for_workers(2);
  msgs::Detect_Request hurried = request();
  hurried.time_budget_ms = 300;
  bool said = false;
  for (int i = 0; i < 10 && !said; ++i) {  // on a busy machine the front may know in time
    wait_for_workers(2);
    second->signal(SIGSTOP);  // it counts as there for a second
    const auto reply = call<msgs::Detect>("detect", hurried);
    second->signal(SIGCONT);
    ASSERT_TRUE(reply) << failure_.message;
    ASSERT_TRUE(reply->success) << reply->status.message;
    said = reply->result.status.message.find("not searched for") != std::string::npos;
    EXPECT_EQ(said, reply->result.models_searched < 4U) << reply->result.status.message;
    EXPECT_TRUE(!said || reply->result.budget_exhausted);
  }
  EXPECT_TRUE(said) << support::read_text(log_of("front"));
  wait_for_workers(2);
  expect_answer(expected());
}

/// What a front logged last of its place: "serves" or "waits"; empty before.
std::string place_of(const std::string& log) {
  const std::string text = support::read_text(log);
  const auto last = [&text](const char* words) {
    const std::size_t at = text.rfind(words);
    return at == std::string::npos ? -1 : static_cast<std::ptrdiff_t>(at);
  };
  const std::ptrdiff_t serves = last("serves as the front");
  const std::ptrdiff_t waits = std::max(last("waits as a front"), last("this one waits"));
  return serves == waits ? "" : serves > waits ? "serves" : "waits";
}

void wait_for_place(const std::string& log, const std::string& place) {
  const auto end = std::chrono::steady_clock::now() + kLong;
  while (place_of(log) != place) {
    ASSERT_LT(std::chrono::steady_clock::now(), end) << support::read_text(log);
    std::this_thread::sleep_for(milliseconds(50));
  }
}

TEST_F(Group, AnotherFrontTakesOver) {
  auto first = start("front", "front", {"--set", "group.strength=2"});
  const msgs::SceneInterpretations answer = expected();
  expect_answer(answer);
  const auto second = start("front", "second");
  const auto worker = start("worker", "worker");
  wait_for_workers(1);
  // It serves until it hears of the first, which a busy machine may delay.
  wait_for_place(log_of("second"), "waits");
  first->signal(SIGKILL);
  expect_answer(answer);
  EXPECT_EQ(place_of(log_of("second")), "serves");
  // The stronger one takes it back, and the other waits.
  first = start("front", "front", {"--set", "group.strength=2"});
  wait_for_place(log_of("second"), "waits");
  expect_answer(answer);
}

}  // namespace
}  // namespace bpa

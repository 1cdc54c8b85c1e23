// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/io/camera_poses_file.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/subscriber.hpp"
#include "tests/support/latest.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"
#include "tests/support/wall_view.hpp"

// Requests from another process, good and bad: each gets its answer and the server goes on.

namespace bpa {
namespace {

namespace msgs = wire::bpa_msgs;
namespace rcl = wire::rcl_interfaces;
using std::chrono::milliseconds;

/// Metres: how far the middle of the wall is.
double middle(const support::WallView& wall) {
  return static_cast<double>(static_cast<float>(
      wall.depth[support::kHeight / 2 * support::kWidth + support::kWidth / 2] * 0.001));
}

TEST(Requests, AnswersCarryTheFramesStampAndPose) {
  support::StubServer server;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message << server.log();
  const support::WallView wall;
  const auto found = client->detect_in(wall.view(123'456'789'012'345));
  ASSERT_TRUE(found.ok()) << found.status().message;
  EXPECT_EQ(found->stamp_ns, 123'456'789'012'345);
  EXPECT_EQ(found->frame_id, "wall");
  EXPECT_EQ(found->models_searched, 1);
  ASSERT_EQ(found->interpretations.size(), 1U);
  EXPECT_EQ(found->interpretations[0].rank, 1);
  ASSERT_EQ(found->best().size(), 1U);
  EXPECT_EQ(found->best()[0].model, "stub");
  EXPECT_EQ(found->best()[0].camera_from_object.position[2], middle(wall));
  EXPECT_EQ(found->best()[0].probability, 0.875);

  const auto models = client->models();
  ASSERT_TRUE(models.ok());
  ASSERT_EQ(models->size(), 1U);
  EXPECT_EQ((*models)[0].name, "stub");
  EXPECT_NEAR((*models)[0].box_max[0], 0.1, 1e-7);

  const auto missing = client->detect_in(wall.view(), {{"teapot"}});
  EXPECT_EQ(missing.status().code, StatusCode::not_found);
  EXPECT_NE(missing.status().message.find("teapot"), std::string::npos);
  EXPECT_EQ(client->load_model("x").code, StatusCode::unsupported);

  const auto status = client->status();
  ASSERT_TRUE(status.ok());
  EXPECT_EQ(status->requests_served, 1U);
  EXPECT_EQ(status->requests_refused, 1U);
  EXPECT_EQ(status->model_count, 1);
  EXPECT_GT(status->memory_bytes, 1'000'000U);

  server.process().signal(SIGTERM);
  EXPECT_EQ(server.process().wait(milliseconds(5000)), 0) << server.log();
}

TEST(Requests, BadInputIsAFailedReplyAndTheServerGoesOn) {
  support::StubServer server;
  auto participant = support::test_participant("tester");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  auto service = wire::ServiceClient<msgs::Detect>::create(*participant, "detect");
  ASSERT_TRUE(service.ok());
  ASSERT_TRUE(service->wait_for_service(milliseconds(10000))) << server.log();

  const float nan = std::numeric_limits<float>::quiet_NaN();
  const struct {
    const char* name;
    std::function<void(msgs::Detect_Request&)> spoil;
    const char* word;
  } cases[] = {
      {"short depth", [](auto& r) { r.frame.depth.resize(10); }, "depth data has 10 bytes"},
      {"long depth", [](auto& r) { r.frame.depth.resize(100000); }, "must have"},
      {"no depth", [](auto& r) { r.frame.depth.clear(); }, "depth"},
      {"short colour", [](auto& r) { r.frame.color.resize(10); }, "color data has 10 bytes"},
      {"zero focal length", [](auto& r) { r.frame.k[0] = 0; }, "fx"},
      {"NaN focal length", [](auto& r) { r.frame.k[4] = std::nan(""); }, "fy"},
      {"empty intrinsics", [](auto& r) { r.frame.k = {}; }, "fx"},
      {"zero size", [](auto& r) { r.frame.width = 0; }, "width"},
      {"huge size", [](auto& r) { r.frame.height = 0xffffffffU; }, "camera height is 4294967295"},
      {"all-zero depth", [](auto& r) { r.frame.depth.assign(r.frame.depth.size(), 0); }, "500"},
      {"all-NaN depth",
       [nan](auto& r) {
         r.frame.depth_encoding = "32FC1";
         r.frame.depth =
             support::as_bytes(std::vector<float>(support::kWidth * support::kHeight, nan));
       },
       "500"},
      {"unknown encoding", [](auto& r) { r.frame.depth_encoding = "64FC1"; }, "16UC1"},
      {"roi outside",
       [](auto& r) {
         r.frame.roi = {60, 40, 20, 20, false};
       },
       "roi"},
      {"mask of another size", [](auto& r) { r.frame.mask.resize(9); }, "mask"},
      {"prior turned otherwise than its distribution",
       [](auto& r) {
         r.frame.priors.resize(1);
         r.frame.priors[0].pose.orientation = {1, 0, 0, 0};
         r.frame.priors[0].orientation.axes = {0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
         r.frame.priors[0].orientation.concentrations = {-100, -100, -100};
       },
       "priors[0].pose.orientation"},
      {"top_k", [](auto& r) { r.top_k = 101; }, "top_k is 101"},
      {"NaN budget", [](auto& r) { r.time_budget_ms = std::nan(""); }, "time_budget_ms"},
      {"negative timeout", [](auto& r) { r.timeout_ms = -1; }, "timeout_ms"},
      {"unknown model", [](auto& r) { r.models = {"teapot"}; }, "teapot"},
  };
  for (const auto& c : cases) {
    msgs::Detect_Request request;
    request.has_frame = true;
    request.frame = support::wall_frame();
    request.frame.header = {{17, 23}, "wrist_camera"};
    c.spoil(request);
    const auto reply = service->call(request, milliseconds(5000));
    ASSERT_TRUE(reply.ok()) << c.name << ": " << reply.status().message;
    EXPECT_FALSE(reply->success) << c.name;
    EXPECT_NE(reply->status.code, 0) << c.name;
    EXPECT_NE(reply->status.message.find(c.word), std::string::npos)
        << c.name << ": " << reply->status.message;
    EXPECT_EQ(to_ns(reply->result.header.stamp), 17'000'000'023) << c.name;
    EXPECT_EQ(reply->result.header.frame_id, "wrist_camera") << c.name;
    EXPECT_EQ(reply->result.status.message, reply->status.message) << c.name;
  }
  msgs::Detect_Request good;
  good.has_frame = true;
  good.frame = support::wall_frame();
  const auto reply = service->call(good, milliseconds(5000));
  ASSERT_TRUE(reply.ok()) << reply.status().message;
  EXPECT_TRUE(reply->success) << reply->status.message;
}

TEST(Requests, AFullQueueIsBusyAndNobodyWaitsForEver) {
  support::StubServer server({"queue.requests=2"}, 400);
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const support::WallView wall;
  std::vector<std::future<Result<DetectionSet>>> answers;
  for (int i = 0; i < 6; ++i) {
    answers.push_back(
        std::async(std::launch::async, [&] { return client->detect_in(wall.view()); }));
  }
  int served = 0, busy = 0, last_place = 0;
  for (auto& answer : answers) {
    const Result<DetectionSet> found = answer.get();
    served += found.ok() ? 1 : 0;
    busy += found.status().code == StatusCode::busy ? 1 : 0;
    if (found.ok()) last_place = std::max(last_place, found->queue_position);
  }
  EXPECT_EQ(served + busy, 6);
  EXPECT_GE(served, 2);
  EXPECT_GE(busy, 3);  // one is searched and two wait
  EXPECT_EQ(last_place, 1);
}

// A client knows its server before the server knows it: a reply that is sent at once is lost.
TEST(Requests, ThoseRightAfterDiscoveryAreAnswered) {
  support::StubServer server;
  for (int i = 0; i < 15; ++i) {
    auto participant = support::test_participant("newcomer" + std::to_string(i));
    ASSERT_TRUE(participant.ok()) << participant.status().message;
    auto service = wire::ServiceClient<msgs::GetStatus>::create(*participant, "get_status");
    ASSERT_TRUE(service.ok());
    const auto reply = service->call({}, milliseconds(10000));
    EXPECT_TRUE(reply.ok()) << i << ": " << reply.status().message << server.log();
  }
}

// Frames of two cameras with nearly one stamp are one search; the third frame waits for its
// partner.
TEST(Requests, FramesOfSeveralCamerasAtNearlyOneTimeAreOneSearch) {
  // One camera's pose is in a file, the other's in TF.
  const std::string poses = support::scratch_folder() + "/cameras.json";
  ASSERT_TRUE(
      io::write_camera_poses(poses, {{"wall_camera", {Eigen::Quaterniond::Identity(), {0, 0, 5}}}})
          .ok());
  support::StubServer server({"tracking.fixed_frame=map", "input.views=[wall_camera, other_camera]",
                              "input.views_tolerance_ms=20", "tracking.tf_wait_ms=1000",
                              "input.camera_poses=" + poses});
  auto participant = support::test_participant("tester");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  support::Latest<msgs::SceneInterpretations> latest;
  auto results = wire::Subscriber<msgs::SceneInterpretations>::create(
      *participant, "interpretations", {wire::qos::results()},
      [&](msgs::SceneInterpretations&& found, const wire::SampleMeta&) { latest.add(found); });
  auto frames =
      wire::Publisher<msgs::RgbdFrame>::create(*participant, "frames", {wire::qos::frames()});
  auto tf = wire::Publisher<wire::tf2_msgs::TFMessage>::create(*participant, "tf_static",
                                                               {wire::qos::static_transforms()});
  ASSERT_TRUE(results.ok() && frames.ok() && tf.ok());
  ASSERT_TRUE(frames->wait_for_matched(milliseconds(10000))) << server.log();
  ASSERT_TRUE(results->wait_for_matched(milliseconds(10000))) << server.log();
  ASSERT_TRUE(tf->wait_for_matched(milliseconds(10000))) << server.log();
  wire::tf2_msgs::TFMessage transforms;
  auto& transform = transforms.transforms.emplace_back();
  transform.header.frame_id = "map";
  transform.child_frame_id = "other_camera";
  transform.transform.rotation.w = 1;
  ASSERT_TRUE(tf->publish(transforms).ok());
  const auto send = [&](const char* camera, std::int64_t stamp_ms) {
    msgs::RgbdFrame frame = support::wall_frame(1'000'000 * stamp_ms);
    frame.header.frame_id = camera;
    ASSERT_TRUE(frames->publish(frame).ok());
  };
  send("wall_camera", 1000);
  send("wall_camera", 1100);   // takes the place of the first
  send("other_camera", 1115);  // is its partner
  const auto at = [&](std::int64_t stamp_ms) {
    return latest.wait_for([&](const msgs::SceneInterpretations& one) {
      return wire::builtin_interfaces::to_ns(one.header.stamp) == 1'000'000 * stamp_ms;
    });
  };
  const auto found = at(1115);
  ASSERT_TRUE(found) << server.log();
  EXPECT_EQ(found->status.message, "");
  EXPECT_EQ(found->header.frame_id, "map");
  const double depth = static_cast<double>(static_cast<float>(
      support::wall_depth_mm()[support::kHeight / 2 * support::kWidth + support::kWidth / 2] *
      0.001));
  EXPECT_EQ(found->interpretations.at(0).placements.at(0).pose.pose.position.z, 5 + depth);
  send("wall_camera", 2000);
  send("other_camera", 2021);  // too late
  send("wall_camera", 2030);
  ASSERT_TRUE(at(2030)) << server.log();
  auto status = wire::ServiceClient<msgs::GetStatus>::create(*participant, "get_status");
  ASSERT_TRUE(status.ok());
  const auto counted = status->call({}, milliseconds(20000));
  ASSERT_TRUE(counted.ok());
  EXPECT_EQ(counted->frames_received, 6U);
  EXPECT_EQ(counted->frames_processed, 4U);
  EXPECT_EQ(counted->frames_dropped, 2U);
}

// Two cameras, whose poses come with the request or from TF.
TEST(Requests, SeveralViewsAreAnsweredInTheFixedFrame) {
  support::StubServer server({"tracking.fixed_frame=map"});
  auto participant = support::test_participant("tester");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  auto service = wire::ServiceClient<msgs::DetectViews>::create(*participant, "detect_views");
  ASSERT_TRUE(service.ok());
  ASSERT_TRUE(service->wait_for_service(milliseconds(10000))) << server.log();
  const auto ask = [&](const msgs::DetectViews_Request& request) {
    auto reply = service->call(request, milliseconds(20000));
    EXPECT_TRUE(reply.ok()) << reply.status().message;
    return reply.ok() ? std::move(*reply) : msgs::DetectViews_Response();
  };
  msgs::DetectViews_Request request;
  request.frames = {support::wall_frame(1'000), support::wall_frame(3'000)};
  request.frames[1].header.frame_id = "other_camera";
  request.scene_from_camera.resize(2);
  for (auto& pose : request.scene_from_camera) pose.orientation.w = 1;
  request.scene_from_camera[0].position.z = 2;
  const auto found = ask(request);
  ASSERT_TRUE(found.success) << found.status.message;
  EXPECT_EQ(found.result.header.frame_id, "map");
  const double depth = static_cast<double>(static_cast<float>(
      support::wall_depth_mm()[support::kHeight / 2 * support::kWidth + support::kWidth / 2] *
      0.001));
  EXPECT_EQ(found.result.interpretations.at(0).placements.at(0).pose.pose.position.z, 2 + depth);
  ASSERT_EQ(found.scene_from_camera.size(), 2u);
  EXPECT_EQ(found.scene_from_camera[0].position.z, 2);
  EXPECT_EQ(found.warnings, (std::vector<std::string>{"wall_camera", "other_camera"}));

  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const support::WallView wall;
  std::vector<PosedFrame> views(2, {wall.view(), ObjectPose()});
  views[0].scene_from_camera.position[2] = 2;
  const auto by_sdk = client->detect_views(views, "map");
  ASSERT_TRUE(by_sdk.ok()) << by_sdk.status().message;
  EXPECT_EQ(by_sdk->found.frame_id, "map");
  EXPECT_EQ(by_sdk->found.best().at(0).camera_from_object.position[2], 2 + depth);
  EXPECT_EQ(by_sdk->scene_from_camera.at(0).position[2], 2);
  EXPECT_EQ(by_sdk->warnings.size(), 2U);
  EXPECT_EQ(client->detect_views({}, "map").status().code, StatusCode::invalid_argument);

  request.scene_from_camera[1].orientation.w = 2;
  EXPECT_EQ(ask(request).status.message,
            "scene_from_camera[1] is no rigid motion: its numbers must be finite and its "
            "quaternion of unit length");
  request.scene_from_camera.resize(1);
  EXPECT_EQ(ask(request).status.message,
            "scene_from_camera has 1 entries; it must have one for each of the 2 frames, or none");
  request.scene_from_camera.clear();
  EXPECT_NE(ask(request).status.message.find("; give scene_from_camera"), std::string::npos);
  request.frames.clear();
  EXPECT_EQ(ask(request).status.message, "frames has 0 entries; it must have 1 to 16");

  // The same poses from TF.
  auto tf = wire::Publisher<wire::tf2_msgs::TFMessage>::create(*participant, "tf_static",
                                                               {wire::qos::static_transforms()});
  ASSERT_TRUE(tf.ok()) << tf.status().message;
  wire::tf2_msgs::TFMessage transforms;
  for (const char* camera : {"wall_camera", "other_camera"}) {
    auto& transform = transforms.transforms.emplace_back();
    transform.header.frame_id = "map";
    transform.child_frame_id = camera;
    transform.transform.rotation.w = 1;
    transform.transform.translation.z = 5;
  }
  ASSERT_TRUE(tf->publish(transforms).ok());
  request.frames = {support::wall_frame(1'000), support::wall_frame(3'000)};
  request.frames[1].header.frame_id = "other_camera";
  msgs::DetectViews_Response by_tf;
  for (int i = 0; i < 100 && !by_tf.success; ++i) {
    by_tf = ask(request);
    std::this_thread::sleep_for(milliseconds(50));
  }
  ASSERT_TRUE(by_tf.success) << by_tf.status.message;
  EXPECT_EQ(by_tf.result.interpretations.at(0).placements.at(0).pose.pose.position.z, 5 + depth);
}

TEST(Requests, AThousandAtOnceAreEachAnswered) {
  support::StubServer server;
  auto participant = support::test_participant("tester");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  auto service = wire::ServiceClient<msgs::Detect>::create(*participant, "detect");
  ASSERT_TRUE(service.ok());
  ASSERT_TRUE(service->wait_for_service(milliseconds(10000))) << server.log();
  msgs::Detect_Request request;
  request.has_frame = true;
  request.frame = support::wall_frame();
  constexpr int kCalls = 1000;
  std::atomic<int> served{0}, refused{0}, lost{0};
  std::vector<std::thread> callers;
  for (int i = 0; i < kCalls; ++i) {
    callers.emplace_back([&] {
      const auto reply = service->call(request, milliseconds(20000));
      ++(!reply.ok() ? lost : reply->success ? served : refused);
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(lost, 0) << served << " served, " << refused << " refused";
  EXPECT_GT(served, 0);
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const auto status = client->status();
  ASSERT_TRUE(status.ok()) << status.status().message;
  EXPECT_EQ(status->requests_served + status->requests_refused, kCalls);
}

// Each loss of a request or reply is a number in /diagnostics.
TEST(Requests, DiagnosticsCountWhatGetsLost) {
  support::StubServer server;
  auto participant = support::test_participant("tester");
  ASSERT_TRUE(participant.ok()) << participant.status().message;
  auto service = wire::ServiceClient<msgs::GetStatus>::create(*participant, "get_status");
  ASSERT_TRUE(service.ok());
  ASSERT_TRUE(service->wait_for_service(milliseconds(10000))) << server.log();
  const auto spec = wire::detail::service_spec<rcl::ListParameters>(
      *participant, "server/list_parameters", wire::qos::services());
  ASSERT_TRUE(spec.ok());
  auto writer = wire::detail::make_writer(*participant, spec->request);
  ASSERT_TRUE(writer.ok()) << writer.status().message;
  ASSERT_TRUE((*writer)->matches().wait_for(1, milliseconds(10000)));
  const std::vector<std::uint8_t> nonsense = {0, 1, 0, 0, 9};
  ASSERT_TRUE((*writer)->write(wire::detail::bytes_ref(nonsense), nullptr, nullptr).ok());
  // A legal request without a reader for its reply, in the framing of rmw_cyclonedds.
  std::vector<std::uint8_t> unheard = {0, 1, 0, 0};
  unheard.resize(4 + 16 + 4 + 4 + 8, 0);
  ASSERT_TRUE((*writer)->write(wire::detail::bytes_ref(unheard), nullptr, nullptr).ok());

  std::mutex mutex;
  std::map<std::string, std::string> values;
  const auto diagnostics = wire::Subscriber<wire::diagnostic_msgs::DiagnosticArray>::create(
      *participant, "diagnostics", {.qos = wire::qos::results()},
      [&](wire::diagnostic_msgs::DiagnosticArray&& array, const wire::SampleMeta&) {
        const std::lock_guard<std::mutex> lock(mutex);
        for (const auto& status : array.status) {
          for (const auto& pair : status.values) values[pair.key] = pair.value;
        }
      });
  ASSERT_TRUE(diagnostics.ok());
  const auto value = [&](const std::string& key) {
    const std::lock_guard<std::mutex> lock(mutex);
    return values[key];
  };
  for (int i = 0; i < 1000 && value("replies not delivered") != "1"; ++i) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_EQ(value("requests malformed"), "1") << server.log();
  EXPECT_EQ(value("replies not delivered"), "1") << server.log();
  EXPECT_EQ(value("requests lost by DDS"), "0");
}

TEST(Requests, WithoutAFrameTheNextOneIsAwaitedInVainAndSaidSo) {
  support::StubServer server;
  auto client = Client::connect(support::client_options());
  ASSERT_TRUE(client.ok()) << client.status().message;
  const auto found = client->detect({}, milliseconds(1500));
  EXPECT_EQ(found.status().code, StatusCode::timeout);
  EXPECT_NE(found.status().message.find("camera"), std::string::npos) << found.status().message;
}

TEST(Requests, NoServerIsUnavailable) {
  ClientOptions options = support::client_options();
  options.timeout = milliseconds(300);
  const auto client = Client::connect(options);
  EXPECT_EQ(client.status().code, StatusCode::unavailable);
  options.timeout = milliseconds(0);
  EXPECT_EQ(Client::connect(options).status().code, StatusCode::invalid_argument);
  options = support::client_options();
  options.server_namespace = "no good";
  EXPECT_EQ(Client::connect(options).status().code, StatusCode::invalid_argument);
}

}  // namespace
}  // namespace bpa

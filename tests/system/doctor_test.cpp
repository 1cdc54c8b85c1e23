// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// bpa doctor as a user meets it: files good and bad, no server, and a server whose camera is a
// ROS 2 style publisher of this process.
#include <atomic>
#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "core/base/clock.hpp"
#include "core/base/failure.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"
#include "core/io/model_file.hpp"
#include "core/modeling/model_source.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "tests/support/l_scene.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/stub_server.hpp"
#include "tests/support/wall_messages.hpp"

namespace bpa {
namespace {

using std::chrono::milliseconds;

std::string scratch(const std::string& name) { return support::scratch_folder() + "/" + name; }

struct DoctorReport {
  int code = -1;
  std::string text;
  std::vector<std::pair<std::string, std::string>> findings;  ///< Subject and what.

  bool has(const std::string& what) const {
    return std::ranges::any_of(findings, [&](const auto& f) { return f.second == what; });
  }
  /// What is wrong with anything but the machine, which is what it is.
  std::vector<std::string> whats() const {
    std::vector<std::string> out;
    for (const auto& [subject, what] : findings) {
      if (subject != "machine") out.push_back(what);
    }
    return out;
  }
};

using Whats = std::vector<std::string>;

DoctorReport doctor(std::vector<std::string> words) {
  const std::string json = scratch("doctor.json"), log = scratch("doctor.log");
  std::filesystem::remove(json);
  words.insert(words.begin(), {BPA_BINARY_DIR "/bin/bpa", "doctor", "--json", json});
  DoctorReport outcome;
  outcome.code = support::run(words, log);
  outcome.text = support::read_text(log);
  const auto written = nlohmann::json::parse(support::read_text(json), nullptr, false);
  if (written.is_discarded()) return outcome;
  for (const auto& finding : written.at("findings")) {
    outcome.findings.emplace_back(finding.at("subject"), finding.at("what"));
  }
  return outcome;
}

/// A brick and an L on a table before a camera, as files, and a library of both.
class Doctor : public test::LScene {
 protected:
  static void SetUpTestSuite() {
    int number = 0;
    for (const auto& [name, mesh] :
         {std::pair{"brick", test::box_mesh(test::kBrickHalf)}, std::pair{"l", test::l_mesh()}}) {
      const auto source = modeling::model_source_from_mesh(mesh, name, ++number);
      ASSERT_TRUE(source.ok()) << source.status().message;
      ASSERT_TRUE(io::save_model(scratch("library"), *source).ok());
    }
    const Frame frame = test::render(everything(), test::kinect_camera(), 0.5f, 3).frame;
    io::GrayImage depth{640, 480, {}};
    for (const float z : frame.depth) {
      depth.pixels.push_back(static_cast<std::uint16_t>(std::lround(1000 * z)));
    }
    ASSERT_TRUE(io::write_gray_png(scratch("depth.png"), depth).ok());
    ASSERT_TRUE(io::write_file(scratch("camera.json"), io::camera_json(frame.camera, 1)).ok());
  }

  static std::vector<std::string> files(const std::string& camera = "camera.json") {
    return {"--depth", scratch("depth.png"), "--camera", scratch(camera)};
  }
};

TEST_F(Doctor, SaysNothingOfGoodFiles) {
  std::vector<std::string> words = files();
  words.insert(words.end(), {"--library", scratch("library")});
  const DoctorReport outcome = doctor(words);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_EQ(outcome.text.rfind("nothing found", 0), 0u) << outcome.text;
  EXPECT_EQ(outcome.whats(), Whats{});
}

TEST_F(Doctor, SaysWhatIsWrongWithFilesAndHowToMendIt) {
  Camera camera = test::kinect_camera();
  ASSERT_TRUE(io::write_file(scratch("unit.json"), io::camera_json(camera, 1000)).ok());
  DoctorReport outcome = doctor(files("unit.json"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.whats(), Whats{"depth is in the wrong unit"});
  EXPECT_EQ(outcome.text.rfind("error: ", 0), 0u) << outcome.text;
  EXPECT_NE(outcome.text.find("\n  remedy: "), std::string::npos) << outcome.text;

  camera.cx = 600;
  ASSERT_TRUE(io::write_file(scratch("center.json"), io::camera_json(camera, 1)).ok());
  outcome = doctor(files("center.json"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.whats(), Whats{"the principal point is far from the centre"});
  EXPECT_EQ(outcome.text.rfind("warning: ", 0), 0u) << outcome.text;

  EXPECT_EQ(doctor(files("none.json")).whats(), Whats{"the frame cannot be read"});
}

TEST_F(Doctor, SaysWhatIsWrongWithALibrary) {
  std::filesystem::create_directories(scratch("empty"));
  EXPECT_EQ(doctor({"--library", scratch("empty")}).whats(), Whats{"it is empty"});
  EXPECT_EQ(doctor({"--library", scratch("none")}).whats(), Whats{"it cannot be read"});
  std::filesystem::copy(scratch("library"), scratch("damaged"),
                        std::filesystem::copy_options::recursive);
  std::filesystem::resize_file(scratch("damaged/l/surface.ply"), 100);
  EXPECT_EQ(doctor({"--library", scratch("damaged")}).whats(), Whats{"the model l cannot be read"});
}

TEST_F(Doctor, TakesAFrameFromACamera) {
  Frame frame = test::render(everything(), test::kinect_camera(), 0.5f, 3).frame;
  frame.color.assign(3 * frame.depth.size(), 5);
  io::BopSceneWriter writer(scratch("set"), "test", 1);
  ASSERT_TRUE(writer.add(0, frame, {}).ok());
  ASSERT_TRUE(writer.finish().ok());
  EXPECT_EQ(doctor({"--sensor", "bop:" + scratch("set")}).whats(), Whats{"colour is too dark"});
  EXPECT_EQ(doctor({"--bop", scratch("set")}).whats(), Whats{"colour is too dark"});
  EXPECT_EQ(doctor({"--sensor", "bop:" + scratch("none"), "--timeout", "1"}).whats(),
            Whats{"the frame cannot be read"});
}

TEST_F(Doctor, WrongUsageIsExitCodeTwo) {
  EXPECT_EQ(doctor({"--bop", "a", "--pcd", "b"}).code, 2);
  EXPECT_EQ(doctor({"--bop", "a", "--sensor", "openni2"}).code, 2);
  EXPECT_EQ(doctor({"--timeout", "x"}).code, 2);
}

std::vector<std::string> server_words(const std::string& timeout_s = "10") {
  return {"--server",
          "--domain",
          std::to_string(support::test_domain()),
          "--namespace",
          support::test_namespace(),
          "--localhost",
          "--timeout",
          timeout_s};
}

/// What doctor and bpa-client say in this environment, without a server.
struct Sayings {
  std::string doctor, client;
  explicit Sayings(const std::string& variable) {
    const auto equals = variable.find('=');
    setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
    doctor = bpa::doctor(server_words("1")).text;
    support::run(support::own_command("bpa-client", {"--localhost", "--timeout", "1", "status"}),
                 scratch("client.log"));
    client = support::read_text(scratch("client.log"));
    unsetenv(variable.substr(0, equals).c_str());
  }
  bool both_say(const char* words) const {
    return doctor.find(words) != std::string::npos && client.find(words) != std::string::npos;
  }
};

TEST_F(Doctor, SaysWhichMiddlewareIsNotReachable) {
  const Sayings zenoh("RMW_IMPLEMENTATION=rmw_zenoh_cpp");
  EXPECT_TRUE(zenoh.both_say("nodes on Zenoh are not reachable")) << zenoh.doctor << zenoh.client;
  const Sayings plain("RMW_IMPLEMENTATION=rmw_fastrtps_cpp");
  EXPECT_EQ(plain.doctor.find("RMW_IMPLEMENTATION is"), std::string::npos) << plain.doctor;
  EXPECT_EQ(plain.client.find('\n'), plain.client.size() - 1) << plain.client;
}

// Fast DDS itself says which of the variables it reads, by a profile that we warn of.
TEST_F(Doctor, SaysThatProfilesAreNotReadIfTheyAreNot) {
  const std::string profile = scratch("profiles.xml");
  ASSERT_TRUE(io::write_file(profile,
                             "<dds><profiles><participant profile_name='bpa'><rtps>"
                             "<useBuiltinTransports>true</useBuiltinTransports>"
                             "</rtps></participant></profiles></dds>")
                  .ok());
  int read = 0;
  for (const std::string variable :
       {"FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"}) {
    const Sayings say(variable + "=" + profile);
    const bool is_read = say.doctor.find("XML profile \"bpa\"") != std::string::npos;
    EXPECT_NE(say.both_say("the Fast DDS profiles are not read"), is_read)
        << variable << say.client;
    read += is_read ? 1 : 0;
  }
  EXPECT_EQ(read, 1);
}

TEST_F(Doctor, SaysThatAZenohRouterRuns) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7447);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int socket_ = socket(AF_INET, SOCK_STREAM, 0), on = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
    ASSERT_EQ(listen(socket_, 1), 0);
  }  // else one runs here
  const Sayings say("RMW_IMPLEMENTATION=");
  close(socket_);
  EXPECT_TRUE(say.both_say("a Zenoh router runs")) << say.doctor << say.client;
}

TEST_F(Doctor, SaysThatThereIsNoServer) {
  const DoctorReport outcome = doctor(server_words("1"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.whats(), Whats{"no server answers"});
}

/// A camera of three topics at 20 Hz.
class Camera20Hz {
 public:
  Camera20Hz(wire::Reliability reliability, milliseconds color_late, milliseconds stamped_late)
      : participant_(or_throw(support::test_participant("camera"))),
        info_(open<wire::sensor_msgs::CameraInfo>("camera/info", reliability)),
        depth_(open<wire::sensor_msgs::Image>("camera/depth", reliability)),
        color_(open<wire::sensor_msgs::Image>("camera/color", reliability)),
        thread_(
            [=, this] { run(color_late.count() * 1'000'000, stamped_late.count() * 1'000'000); }) {}
  ~Camera20Hz() {
    ended_ = true;
    thread_.join();
  }
  Camera20Hz(const Camera20Hz&) = delete;
  Camera20Hz& operator=(const Camera20Hz&) = delete;

 private:
  template <class T>
  wire::Publisher<T> open(const char* topic, wire::Reliability reliability) {
    wire::PublisherOptions options;
    options.qos = {reliability, wire::Durability::volatile_, 5, 0};
    return or_throw(wire::Publisher<T>::create(participant_, topic, options));
  }
  void run(std::int64_t color_late_ns, std::int64_t stamped_late_ns) {
    while (!ended_) {
      const std::int64_t stamp = unix_time_ns() + stamped_late_ns;
      EXPECT_TRUE(info_.publish(support::wall_camera_info(stamp)).ok());
      EXPECT_TRUE(depth_.publish(support::wall_depth_image(stamp)).ok());
      EXPECT_TRUE(color_.publish(support::wall_color_image(stamp + color_late_ns)).ok());
      std::this_thread::sleep_for(milliseconds(50));
    }
  }

  wire::Participant participant_;
  wire::Publisher<wire::sensor_msgs::CameraInfo> info_;
  wire::Publisher<wire::sensor_msgs::Image> depth_, color_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

class DoctorOfAServer : public Doctor {
 protected:
  void start(const std::vector<std::string>& settings = {}) {
    std::vector<std::string> words =
        support::own_command("bpa-server", {"--library", scratch("library"), "--threads", "1"});
    for (const std::string setting : {"input.color=camera/color", "input.depth=camera/depth",
                                      "input.camera_info=camera/info"}) {
      words.insert(words.end(), {"--set", setting});
    }
    for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    server_.emplace(words, scratch("server.log"));
    ASSERT_TRUE(Client::connect(support::client_options()).ok()) << log();
  }
  static std::string log() { return support::read_text(scratch("server.log")); }
  static DoctorReport ask() { return doctor(server_words()); }
  /// While this camera has sent frames for a second.
  static DoctorReport ask_with_camera(milliseconds color_late, milliseconds stamped_late) {
    const Camera20Hz camera(wire::Reliability::best_effort, color_late, stamped_late);
    std::this_thread::sleep_for(milliseconds(1000));
    return ask();
  }

  std::optional<support::Process> server_;
};

TEST_F(DoctorOfAServer, SaysNothingWhenFramesComeAndWhenTheyDoNotThatNobodySendsThem) {
  start();
  EXPECT_EQ(ask().whats(), Whats{"the server gets no frames"});
  const DoctorReport outcome = ask_with_camera(milliseconds(0), milliseconds(0));
  EXPECT_EQ(outcome.whats(), Whats{}) << outcome.text << log();
}

TEST_F(DoctorOfAServer, SaysInItsLogWhichMiddlewareIsNotReachable) {
  setenv("RMW_IMPLEMENTATION", "rmw_zenoh_cpp", 1);
  start();
  unsetenv("RMW_IMPLEMENTATION");
  EXPECT_NE(log().find("nodes on Zenoh are not reachable"), std::string::npos) << log();
}

TEST_F(DoctorOfAServer, SaysThatStampsAreApart) {
  start();
  const DoctorReport outcome = ask_with_camera(milliseconds(22), milliseconds(0));
  EXPECT_EQ(outcome.whats(), Whats{"depth images come without a colour image of their time"})
      << outcome.text << log();
}

TEST_F(DoctorOfAServer, SaysThatQosDoesNotMatch) {
  start({"input.reliable=true"});
  const DoctorReport outcome = ask_with_camera(milliseconds(0), milliseconds(0));
  EXPECT_EQ(outcome.whats(), Whats{"publishers and the server do not match in QoS"})
      << outcome.text << log();
}

TEST_F(DoctorOfAServer, SaysThatClocksAreApart) {
  start();
  const DoctorReport outcome = ask_with_camera(milliseconds(0), milliseconds(60'000));
  EXPECT_EQ(outcome.whats(), Whats{"frames are stamped in the future"}) << outcome.text << log();
}

}  // namespace
}  // namespace bpa

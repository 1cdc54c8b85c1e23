// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What DDS Security costs a frame of 1.5 MB between two processes of this machine, over UDP. Usage:
// secure_latency [SAMPLES [RATE_HZ]]. Lines: protection, then the latency from before publish() to
// inside the callback (median, 99 %, maximum in ms), processor time per frame of both ends in ms,
// and how many frames came.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "idl/wire/messages.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/subscriber.hpp"
#include "server/security/keystore.hpp"
#include "tests/support/process.hpp"

namespace {

using namespace bpa;
using Clock = std::chrono::steady_clock;
using Frame = wire::bpa_msgs::RgbdFrame;

constexpr std::uint32_t kWidth = 640, kHeight = 480;
constexpr const char* kTopic = "/frames";
constexpr const char* kEnclave = "/latency";

std::int64_t now_ns() { return Clock::now().time_since_epoch().count(); }

/// Of all threads of this process.
double cpu_ms() {
  timespec time = {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

Result<wire::Participant> join(const std::string& name, const std::string& keystore, int domain) {
  wire::ParticipantOptions options;
  options.node.name = name;
  wire::Discovery discovery;
  discovery.domain_id = domain;
  discovery.range = wire::DiscoveryRange::localhost;
  options.discovery = discovery;
  options.security = {keystore, kEnclave};
  return wire::Participant::create(std::move(options));
}

int send(const std::string& keystore, int domain, int samples, int rate_hz) {
  const auto participant = join("sender", keystore, domain);
  if (!participant.ok()) return 1;
  wire::PublisherOptions options;
  options.qos = wire::qos::frames();
  auto publisher = wire::Publisher<Frame>::create(*participant, kTopic, options);
  if (!publisher.ok() || !publisher->wait_for_matched(std::chrono::seconds(10))) return 1;
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const std::vector<std::uint8_t> color(3U * kWidth * kHeight, 7), depth(2U * kWidth * kHeight, 9);
  const double before = cpu_ms();
  auto next = Clock::now();
  for (int i = 0; i < samples; ++i) {
    next += std::chrono::nanoseconds(1'000'000'000 / rate_hz);
    std::this_thread::sleep_until(next);
    wire::bpa_msgs::RgbdFrameView frame;
    frame.header.stamp = wire::builtin_interfaces::from_ns(now_ns());
    frame.width = kWidth;
    frame.height = kHeight;
    frame.color_encoding = "rgb8";
    frame.color = {color.data(), color.size()};
    frame.depth_encoding = "16UC1";
    frame.depth = {depth.data(), depth.size()};
    (void)publisher->publish(frame).ok();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::printf("%.3f", (cpu_ms() - before) / samples);  // the other end reads it
  return 0;
}

/// One line. `keystore` empty: without security.
void measure(const char* program, const std::string& name, const std::string& keystore, int domain,
             int samples, int rate_hz) {
  const auto participant = join("receiver", keystore, domain);
  if (!participant.ok()) return (void)std::printf("%s\n", participant.status().message.c_str());
  std::mutex mutex;
  std::vector<double> ms;
  double first_cpu = 0, last_cpu = 0;
  wire::SubscriberOptions options;
  options.qos = wire::qos::reliable_input();
  const auto subscriber = wire::Subscriber<Frame>::create(
      *participant, kTopic, options, [&](Frame&& frame, const wire::SampleMeta&) {
        const std::int64_t sent = wire::builtin_interfaces::to_ns(frame.header.stamp);
        const std::lock_guard<std::mutex> lock(mutex);
        ms.push_back(1e-6 * static_cast<double>(now_ns() - sent));
        last_cpu = cpu_ms();
        if (ms.size() == 1) first_cpu = last_cpu;
      });
  if (!subscriber.ok()) return (void)std::printf("%s\n", subscriber.status().message.c_str());
  const std::string log = support::scratch_folder() + "/sender";
  const int code = support::run({program, "--send", keystore, std::to_string(domain),
                                 std::to_string(samples), std::to_string(rate_hz)},
                                log, std::chrono::milliseconds(30'000 + 3000 * samples / rate_hz));
  const std::lock_guard<std::mutex> lock(mutex);
  std::sort(ms.begin(), ms.end());
  if (code != 0 || ms.size() < 2) return (void)std::printf("%s: nothing came\n", name.c_str());
  const double received = (last_cpu - first_cpu) / static_cast<double>(ms.size() - 1);
  std::printf("%-42s %7.2f %7.2f %7.2f   %6s %6.2f   %zu of %d\n", name.c_str(), ms[ms.size() / 2],
              ms[ms.size() * 99 / 100], ms.back(), support::read_text(log).c_str(), received,
              ms.size(), samples);
  std::fflush(stdout);
}

/// A keystore whose governance has other protections, signed by the openssl command.
std::string keystore_with(const char* name, const char* rtps, const char* metadata,
                          const char* data, int domain) {
  const std::string folder = support::scratch_folder() + "/" + name;
  server::make_keystore(folder, {{kEnclave, {"*"}, {"*"}}}, domain);
  std::string governance = support::read_text(folder + "/enclaves/governance.xml");
  const auto set = [&governance](const std::string& element, const std::string& kind) {
    const std::size_t begin = governance.find("<" + element + ">") + element.size() + 2;
    governance.replace(begin, governance.find('<', begin) - begin, kind);
  };
  set("rtps_protection_kind", rtps);
  set("metadata_protection_kind", metadata);
  set("data_protection_kind", data);
  std::ofstream(folder + "/governance.xml") << governance;
  support::run({"/usr/bin/openssl", "smime", "-sign", "-text", "-in", folder + "/governance.xml",
                "-out", folder + "/enclaves" + kEnclave + "/governance.p7s", "-signer",
                folder + "/public/ca.cert.pem", "-inkey", folder + "/private/ca.key.pem"},
               "");
  return folder;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 6 && std::string(argv[1]) == "--send") {
    return send(argv[2], std::atoi(argv[3]), std::atoi(argv[4]), std::atoi(argv[5]));
  }
  const int samples = argc > 1 ? std::atoi(argv[1]) : 300;
  const int rate_hz = argc > 2 ? std::atoi(argv[2]) : 30;
  const int domain = support::test_domain();
  std::printf(
      "%d Hz, 640x480, RgbdFrame of 1.5 MB          median    99 %%     max     CPU: sends, "
      "receives\n",
      rate_hz);
  const auto run = [&](const char* name, const std::string& keystore) {
    measure(argv[0], name, keystore, domain, samples, rate_hz);
  };
  run("none", "");
  run("packets signed", keystore_with("signed", "SIGN", "NONE", "NONE", domain));
  run("messages encrypted", keystore_with("encrypted", "NONE", "ENCRYPT", "NONE", domain));
  run("both (--make-keystore)", keystore_with("both", "SIGN", "ENCRYPT", "NONE", domain));
  run("both, and data encrypted (SROS 2)",
      keystore_with("sros2", "SIGN", "ENCRYPT", "ENCRYPT", domain));
  return 0;
}

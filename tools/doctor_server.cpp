// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <thread>

#include "core/base/concat.hpp"
#include "core/doctor/machine_check.hpp"
#include "idl/wire/endpoint.hpp"
#include "idl/wire/middleware.hpp"
#include "tools/doctor.hpp"

namespace bpa::cli {
namespace {

using std::chrono::milliseconds;

// Chosen by hand.
constexpr milliseconds kWatch{2000};  // between two statuses
constexpr double kMaxLost = 0.1;      // share of messages or images
constexpr double kMinLost = 3;        // of them; fewer are lost when a camera starts
constexpr double kFuture_ms = 500;    // what synchronised clocks are never apart
constexpr double kPast_ms = 5000;     // what no sensor, network or queue delays
constexpr std::uint64_t kImageBytes = 640 * 480 * 3;  // rgb8: the largest usual message

using Values = std::map<std::string, double>;

/// ServerStatus::details of two statuses: the server's diagnostics. A key that is not there is 0.
struct Details {
  Values now, grown;

  Details(const ServerStatus& before, const ServerStatus& after) {
    for (const auto& [key, text] : after.details) {
      now[key] = std::strtod(text.c_str(), nullptr);
      grown[key] += now[key];
    }
    for (const auto& [key, text] : before.details) {
      grown[key] -= std::strtod(text.c_str(), nullptr);
    }
  }
};

double value_of(const Values& values, const std::string& key) {
  const auto found = values.find(key);
  return found == values.end() ? 0 : found->second;
}

/// The sum of all values whose keys begin so.
double sum_of(const Values& values, const std::string& start) {
  double sum = 0;
  for (const auto& [key, value] : values) sum += key.rfind(start, 0) == 0 ? value : 0;
  return sum;
}

/// Why no frame has come.
doctor::Finding explain_silence(const Details& details) {
  const double weak = sum_of(details.now, "publishers with too weak QoS of ");
  if (weak > 0) {
    return {doctor::Severity::error, "publishers and the server do not match in QoS",
            concat(weak, " publishers offer less than the server asks for (reliable)"),
            "Publish reliable, or set input.reliable (camera topics) or input.frames_reliable to "
            "false."};
  }
  if (details.now.contains("capture: sets of images")) {
    return {doctor::Severity::error, "the server's camera gives no frames",
            "it cannot be opened, or is open and silent",
            "Plug the sensor in and end other programs that use it; bpa-server --list-devices says "
            "what is wrong with it."};
  }
  std::string missing;
  const std::string publishers = "publishers of ";
  for (const auto& [key, value] : details.now) {
    if (!key.starts_with(publishers) || value > 0) continue;
    missing += (missing.empty() ? "" : ", ") + key.substr(publishers.size());
  }
  if (sum_of(details.now, "publishers of ") == 0) {
    return {
        doctor::Severity::warning, "the server gets no frames",
        "nobody publishes them (" + missing + ")",
        "Start the camera's driver in the server's domain, and set input.color, input.depth and "
        "input.camera_info to its topics (`ros2 topic list`)."};
  }
  return {doctor::Severity::warning, "the server gets no frames",
          missing.empty() ? "there are publishers, but nothing comes"
                          : "there are publishers, but none of " + missing,
          "Check that the camera is not paused (`ros2 topic hz`) and that the server's inputs name "
          "all of its topics."};
}

void check_stamps(const Details& details, doctor::Findings& findings) {
  const double sets = sum_of(details.grown, "camera sets with ");
  for (const std::string partner : {"colour image", "camera info"}) {
    const double lost = value_of(details.grown, "depth images without a " + partner);
    if (lost < kMinLost || lost < kMaxLost * (lost + sets)) continue;
    const double apart_ms = value_of(details.now, "ms to the nearest image that was too far");
    findings.push_back(
        {doctor::Severity::error, "depth images come without a " + partner + " of their time",
         concat(lost, " of ", lost + sets, " depth images",
                apart_ms > 0 ? concat("; the nearest stamps are ", apart_ms, " ms apart") : ""),
         "Switch on the driver's synchronisation of its images, run both at one rate, or raise "
         "input.sync_tolerance_ms and input.sync_queue."});
  }
}

void check_drops(const Details& details, doctor::Findings& findings) {
  for (const auto& [key, count] : details.grown) {
    if (!key.starts_with("rejected: ") || count <= 0) continue;
    findings.push_back(
        {doctor::Severity::error,
         "the server refuses frames: " + key.substr(std::string("rejected: ").size()),
         concat(count, " in ", kWatch.count() / 1000, " s"),
         "The server's log says which rule they break; depth must be registered to "
         "colour, of its size, 16UC1 or 32FC1."});
  }
  if (const double failed = value_of(details.grown, "frames failed in the search"); failed > 0) {
    findings.push_back({doctor::Severity::error, "the server's search fails",
                        concat(failed, " frames in ", kWatch.count() / 1000, " s"),
                        "The server's log says why."});
  }
  const double lost = sum_of(details.grown, "messages lost by DDS of ");
  const double messages = sum_of(details.grown, "messages of ");
  if (lost >= kMinLost && lost > kMaxLost * (lost + messages)) {
    findings.push_back({doctor::Severity::warning, "messages to the server are lost on the way",
                        concat(lost, " of ", lost + messages),
                        "Raise net.core.rmem_max to 8388608 on the server, use a wired network, or "
                        "compressed images (input.color_transport, input.depth_transport)."});
  }
  if (const double bad = sum_of(details.grown, "messages malformed of "); bad > 0) {
    findings.push_back({doctor::Severity::error, "messages to the server cannot be decoded",
                        concat(bad, " in ", kWatch.count() / 1000, " s"),
                        "Build the publisher with the same message definitions (idl/bpa_msgs)."});
  }
}

void check_clock(const Details& details, doctor::Findings& findings) {
  const double age_ms = value_of(details.now, "ms from the last frame's stamp until it came");
  if (age_ms < -kFuture_ms) {
    findings.push_back({doctor::Severity::warning, "frames are stamped in the future",
                        concat("the last one by ", fixed(-0.001 * age_ms, 1), " s"),
                        "Synchronise the clocks of camera and server (chrony, PTP)."});
  }
  if (age_ms > kPast_ms) {
    findings.push_back({doctor::Severity::warning, "frames are stamped long before they come",
                        concat("the last one by ", fixed(0.001 * age_ms, 1), " s"),
                        "Synchronise the clocks of camera and server (chrony, PTP), and have the "
                        "driver stamp in Unix time. A bag that is played is stamped like this."});
  }
}

std::string environment() {
  std::string text;
  for (const char* name : {"ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY",
                           "ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER"}) {
    const char* value = std::getenv(name);
    if (value != nullptr) text += concat("; ", name, " is ", value);
  }
  return text;
}

doctor::Finding explain_absence(const Status& status) {
  if (status.code == StatusCode::invalid_argument) {
    return {doctor::Severity::error, "DDS cannot start", status.message, "Correct this setting."};
  }
  std::string remedy =
      "Start `bpa-server --library DIR`. Give both the same ROS_DOMAIN_ID (--domain), namespace "
      "(--namespace), ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_LOCALHOST_ONLY and keystore (--keystore).";
  if (std::getenv("ROS_DISCOVERY_SERVER") != nullptr) {
    remedy +=
        " Check that the discovery server of ROS_DISCOVERY_SERVER runs, or unset it for both.";
  }
  return {doctor::Severity::error, "no server answers",
          status.message.substr(0, status.message.find('\n')) + environment(), remedy};
}

doctor::MachineNeeds machine_needs(const ClientOptions& options, bool found) {
  doctor::MachineNeeds needs;
  const auto discovery = wire::discovery_from_environment();
  const wire::Discovery given = discovery.ok() ? *discovery : wire::Discovery();
  needs.domain = options.domain >= 0 ? options.domain : given.domain_id;
  // A server that answers was found without it, if need be.
  needs.multicast = !found && options.range_from_environment &&
                    given.range == wire::DiscoveryRange::subnet && given.static_peers.empty();
  needs.image_bytes = kImageBytes;
  return needs;
}

/// Two statuses some time apart.
Result<doctor::Findings> watch(Client& client, milliseconds time) {
  const auto before = client.status();
  if (!before.ok()) return before.status();
  std::this_thread::sleep_for(time);
  const auto after = client.status();
  if (!after.ok()) return after.status();
  return check_server(*before, *after);
}

}  // namespace

doctor::Findings check_server(const ServerStatus& before, const ServerStatus& after) {
  doctor::Findings findings;
  const Details details(before, after);
  if (after.model_count == 0) {
    findings.push_back({doctor::Severity::error, "the server has no models",
                        "its library is " + after.library,
                        "Make models (`bpa model from-mesh`) and load them (`bpa-client load`)."});
  }
  check_stamps(details, findings);
  const bool silent = after.frames_received == before.frames_received;
  if (!silent) check_clock(details, findings);
  if (silent && findings.empty()) findings.push_back(explain_silence(details));
  check_drops(details, findings);
  return findings;
}

RunningFindings check_running_server(ClientOptions options) {
  std::mutex mutex;
  doctor::Findings complaints;
  options.log = [&](const std::string& text) {
    const std::lock_guard lock(mutex);
    complaints.push_back({doctor::Severity::warning, "DDS complains", text,
                          "Run server and client of one release with the default QoS."});
  };
  RunningFindings found;
  bool answered = false;
  {
    auto client = Client::connect(options);
    answered = client.ok();
    const Result<doctor::Findings> watched =
        answered ? watch(*client, std::min(kWatch, options.timeout)) : client.status();
    found.server = watched.ok() ? *watched : doctor::Findings{explain_absence(watched.status())};
  }  // the hook is not called any more
  found.server.insert(found.server.end(), complaints.begin(), complaints.end());
  found.machine = doctor::check_machine(machine_needs(options, answered));
  for (const auto& note : wire::check_middleware(options.range_from_environment)) {
    found.machine.push_back({note.unreachable ? doctor::Severity::error : doctor::Severity::warning,
                             note.what, note.why, note.remedy});
  }
  return found;
}

}  // namespace bpa::cli

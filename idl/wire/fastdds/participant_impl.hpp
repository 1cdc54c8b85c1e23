// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "idl/wire/fastdds/leases.hpp"
#include "idl/wire/fastdds/version.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/private/enclave.hpp"
#include "idl/wire/private/graph.hpp"
#include "idl/wire/task_thread.hpp"

// Private to idl/wire/fastdds, the only folder that includes Fast DDS.

namespace bpa::wire::detail {

Guid to_guid(const rtps::GUID_t& guid);
Guid to_guid(const rtps::InstanceHandle_t& handle);
SampleId to_id(const rtps::SampleIdentity& identity);
rtps::SampleIdentity to_identity(const SampleId& id);

/// Owns the DDS participant, its topics and types, and its entry in the ROS 2 graph.
class ParticipantImpl : public std::enable_shared_from_this<ParticipantImpl> {
 public:
  ParticipantImpl(ParticipantOptions options, Discovery discovery, Enclave enclave);
  ~ParticipantImpl();
  Status start();

  const ParticipantOptions& options() const { return options_; }
  int domain_id() const { return discovery_.domain_id; }
  const Enclave& enclave() const { return enclave_; }
  GraphLayout graph_layout() const;
  void log(LogLevel level, const std::string& text,
           SourceLocation location = SourceLocation::current()) const {
    bpa::log(options_.log, level, text, location);
  }
  /// The same of what a peer's endpoint caused.
  void log_peer(LogLevel level, const Guid& peer, const std::string& text,
                SourceLocation location = SourceLocation::current()) const {
    bpa::log(hook_of_peer(options_.log, to_text(peer)), level, text, location);
  }

  dds::Publisher* publisher() { return publisher_; }
  dds::Subscriber* subscriber() { return subscriber_; }
  TaskThread& tasks() { return tasks_; }
  Guid guid() const { return participant_of(to_guid(participant_->guid())); }

  /// Makes an endpoint on its topic and lists it in the graph. `make` makes the DDS entity and
  /// gives back its GUID, zero when Fast DDS refuses it. `internal` says what was refused and why;
  /// `unsupported`: by the permissions of our enclave.
  Status open(const EndpointSpec& spec, bool is_reader,
              const std::function<Guid(dds::Topic*)>& make);
  /// The reverse; `end` deletes the DDS entity.
  void close(const EndpointSpec& spec, const Guid& guid, const std::function<void()>& end);

  /// An endpoint of a peer came, changed or went.
  struct Peer {
    enum class Change { came, changed, went } change = Change::went;
    bool is_reader = false;
    bool only_xcdr2 = false;  ///< Not the encoding of ROS 2, which is ours.
    Guid guid{};
    std::string topic, type, user_data;
    Qos qos;  ///< Its reliability and durability.
  };
  void on_peer(const Peer& peer);
  /// As detail::find_published().
  std::optional<EndpointSpec> find_published(const std::string& dds_topic) const;

 private:
  struct TopicEntry {
    dds::Topic* topic = nullptr;
    std::string dds_type;
    int users = 0;
  };

  /// The topic, made when it is the first of its name; null, with the reason, when Fast DDS refuses
  /// it or another type has the name. The caller of both holds endpoint_mutex_.
  dds::Topic* acquire_topic(const EndpointSpec& spec, std::string* error);
  void release_topic(const std::string& dds_topic);
  /// Says so when a peer uses one of our topics with another type or encoding: DDS itself is
  /// silent.
  void check_type(const Peer& peer, const std::string& ours) const;
  /// Says so when another process offers a service that we offer: clients get two answers.
  void check_servers(const Peer& peer);
  void serve(const std::string& dds_topic);
  void publish_graph();

  const ParticipantOptions options_;
  const Discovery discovery_;
  const Enclave enclave_;
  const std::unique_ptr<dds::DomainParticipantListener> listener_;
  std::int32_t number_ = -1;  ///< In this process; -1: the user's profile gives one.
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;

  std::mutex endpoint_mutex_;                      // held while an endpoint is made or ended
  std::map<std::string, TopicEntry> topics_;       // by DDS name
  std::map<std::string, dds::TypeSupport> types_;  // by DDS name

  std::mutex graph_mutex_;
  std::set<Guid> readers_, writers_;
  std::unique_ptr<RawWriter> graph_writer_;

  // Of discovery callbacks, which hold locks of Fast DDS: who holds this one calls nothing of it.
  mutable std::mutex discovery_mutex_;
  GraphLayoutGuess guess_;
  std::map<std::string, std::string> our_types_;  // by DDS name of the topic
  std::map<Guid, Peer> peers_;                    // those of ROS 2, as many as kMaxPeers
  std::set<std::string> our_services_;            // DDS names of their request topics
  Guid ours_{};                                   // our participant, entity 0
  std::set<Guid> rivals_;                         // participants that offer one of them, too

  const std::shared_ptr<Leases> leases_ = std::make_shared<Leases>(tasks_);
  TaskThread tasks_;  // last: its tasks use the others
};

/// As make_writer, for a participant that is not public yet.
Result<std::unique_ptr<RawWriter>> make_raw_writer(std::shared_ptr<ParticipantImpl> participant,
                                                   EndpointSpec spec);

}  // namespace bpa::wire::detail

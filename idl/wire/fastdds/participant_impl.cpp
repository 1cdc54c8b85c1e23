// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/fastdds/participant_impl.hpp"

#include <algorithm>
#include <cstring>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>

#include "core/base/concat.hpp"
#include "idl/wire/fastdds/dds_qos.hpp"
#include "idl/wire/fastdds/raw_type.hpp"
#include "idl/wire/msg/rmw_dds_common.hpp"

#if BPA_FASTDDS_MAJOR < 3
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#endif

namespace bpa::wire {
namespace detail {

namespace {

/// So many endpoints of peers are remembered, for topics that we open later.
constexpr std::size_t kMaxPeers = 4096;
constexpr const char* kParticipantProfile = "bpa";
constexpr const char* kRequestPrefix = "rq/";

/// Participants of one process reach each other by UDP, as those of two do, unless an XML profile
/// says otherwise. Fast DDS 2 hands data straight to the readers of another participant, even to
/// deleted ones: eProsima/Fast-DDS#5034.
void avoid_deleted_readers() {
#if BPA_FASTDDS_MAJOR < 3
  static const bool done = [] {
    eprosima::fastrtps::LibrarySettingsAttributes settings;
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
    return true;
  }();
  static_cast<void>(done);
#endif
}

// Numbers of this process's participants. A participant's ports follow from its number, and
// discovery by unicast tries those of the first 32 alone. Fast DDS before 2.11 gives none a second
// time, so that a program which joins and leaves often would not be found any more.
std::mutex numbers_mutex;
std::set<std::int32_t> numbers;

std::int32_t take_number() {
  const std::lock_guard<std::mutex> lock(numbers_mutex);
  std::int32_t number = 0;
  while (!numbers.insert(number).second) ++number;
  return number;
}

void release_number(std::int32_t number) {
  const std::lock_guard<std::mutex> lock(numbers_mutex);
  numbers.erase(number);
}

}  // namespace

Guid to_guid(const rtps::GUID_t& guid) {
  Guid result;
  std::memcpy(result.data(), guid.guidPrefix.value, 12);
  std::memcpy(result.data() + 12, guid.entityId.value, 4);
  return result;
}

Guid to_guid(const rtps::InstanceHandle_t& handle) { return to_guid(rtps::iHandle2GUID(handle)); }

SampleId to_id(const rtps::SampleIdentity& identity) {
  if (identity.writer_guid() == rtps::c_Guid_Unknown) return {};
  return {to_guid(identity.writer_guid()),
          static_cast<std::int64_t>(identity.sequence_number().to64long())};
}

rtps::SampleIdentity to_identity(const SampleId& id) {
  rtps::GUID_t writer;
  std::memcpy(writer.guidPrefix.value, id.writer.data(), 12);
  std::memcpy(writer.entityId.value, id.writer.data() + 12, 4);
  rtps::SampleIdentity identity;
  identity.writer_guid(writer);
  if (id.sequence != 0) {  // else unknown, as in a request
    identity.sequence_number(rtps::SequenceNumber_t(static_cast<std::uint64_t>(id.sequence)));
  }
  return identity;
}

namespace {

/// Tells of the endpoints of peers.
class Listener : public dds::DomainParticipantListener {
 public:
  explicit Listener(ParticipantImpl& participant) : participant_(participant) {}

 private:
#if BPA_FASTDDS_MAJOR >= 3
  void on_data_writer_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryStatus status,
                                const dds::PublicationBuiltinTopicData& data, bool&) override {
    using Change = rtps::WriterDiscoveryStatus;
    tell(data, false, status, Change::DISCOVERED_WRITER, Change::CHANGED_QOS_WRITER);
  }
  void on_data_reader_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryStatus status,
                                const dds::SubscriptionBuiltinTopicData& data, bool&) override {
    using Change = rtps::ReaderDiscoveryStatus;
    tell(data, true, status, Change::DISCOVERED_READER, Change::CHANGED_QOS_READER);
  }
#else
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    tell(info.info, false, info.status, info.DISCOVERED_WRITER, info.CHANGED_QOS_WRITER);
  }
  void on_subscriber_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) override {
    tell(info.info, true, info.status, info.DISCOVERED_READER, info.CHANGED_QOS_READER);
  }
#endif

  /// `came` and `changed` are what the `change` may be, else the endpoint went.
  template <class Data, class Change>
  void tell(const Data& data, bool is_reader, Change change, Change came, Change changed) {
    const Status status = guarded("a peer's endpoint was not noted", [&] {
      participant_.on_peer(peer_of(data, is_reader, change, came, changed));
    });
    if (!status.ok()) participant_.log(LogLevel::error, status.message);
  }

  template <class Data, class Change>
  static ParticipantImpl::Peer peer_of(const Data& data, bool is_reader, Change change, Change came,
                                       Change changed) {
    ParticipantImpl::Peer peer;
    if (change == came) peer.change = ParticipantImpl::Peer::Change::came;
    if (change == changed) peer.change = ParticipantImpl::Peer::Change::changed;
    peer.is_reader = is_reader;
#if BPA_FASTDDS_MAJOR >= 3
    peer.guid = to_guid(data.guid);
    peer.topic = data.topic_name.to_string();
    peer.type = data.type_name.to_string();
    const auto& user_data = data.user_data.data_vec();
    const auto& representation = data.representation.m_value;
    const auto& reliability = data.reliability;
    const auto& durability = data.durability;
#else
    peer.guid = to_guid(data.guid());
    peer.topic = data.topicName().to_string();
    peer.type = data.typeName().to_string();
    const auto& user_data = data.m_qos.m_userData.data_vec();
    const auto& representation = data.m_qos.representation.m_value;
    const auto& reliability = data.m_qos.m_reliability;
    const auto& durability = data.m_qos.m_durability;
#endif
    if (reliability.kind != dds::RELIABLE_RELIABILITY_QOS) {
      peer.qos.reliability = Reliability::best_effort;
    }
    if (durability.kind != dds::VOLATILE_DURABILITY_QOS) {
      peer.qos.durability = Durability::transient_local;
    }
    // Empty: XCDR1.
    peer.only_xcdr2 =
        !representation.empty() && std::find(representation.begin(), representation.end(),
                                             dds::XCDR_DATA_REPRESENTATION) == representation.end();
    peer.user_data.assign(user_data.begin(), user_data.end());
    return peer;
  }

  ParticipantImpl& participant_;
};

}  // namespace

ParticipantImpl::ParticipantImpl(ParticipantOptions options, Discovery discovery, Enclave enclave)
    : options_(std::move(options)),
      discovery_(std::move(discovery)),
      enclave_(std::move(enclave)),
      listener_(std::make_unique<Listener>(*this)),
      tasks_(options_.log) {}

Status ParticipantImpl::start() {
  avoid_deleted_readers();
  auto* factory = dds::DomainParticipantFactory::get_instance();
  // Of the environment, which Fast DDS otherwise reads after the profile below is asked for. It
  // says itself what it cannot read.
  (void)factory->load_profiles();
  if (!options_.profiles.empty() &&
      !succeeded(factory->load_XML_profiles_file(options_.profiles))) {
    return invalid_argument(options_.profiles + ": not a file of Fast DDS XML profiles");
  }
  dds::DomainParticipantQos profile;
  const bool has_profile =
      succeeded(factory->get_participant_qos_from_profile(kParticipantProfile, profile));
  Result<dds::DomainParticipantQos> qos =
      participant_qos(discovery_, options_, enclave_, leases_, has_profile ? &profile : nullptr);
  if (!qos.ok()) return qos.status();
  if (has_profile && qos->transport().use_builtin_transports) {
    log(LogLevel::warning,
        "the XML profile \"bpa\" uses Fast DDS's built-in transports: the shared memory of Fast "
        "DDS 2.9.1 (Debian 12) fits no other release, and makes ROS 2 nodes on this machine abort");
  }
  const auto domain = static_cast<dds::DomainId_t>(discovery_.domain_id);
  const auto create = [&] {
    return factory->create_participant(domain, *qos, listener_.get(), dds::StatusMask::none());
  };
  if (qos->wire_protocol().participant_id < 0) {
    number_ = take_number();
    qos->wire_protocol().participant_id = number_;
    participant_ = create();
    qos->wire_protocol().participant_id = -1;
  }
  if (participant_ == nullptr) participant_ = create();  // its number is another participant's
  if (participant_ == nullptr) {
    return unavailable("cannot join DDS domain ", discovery_.domain_id,
                       ": no UDP port or no network interface is free",
                       enclave_.secure() ? ", or " + enclave_.folder + " is not in order" : "");
  }
  publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    return Status(StatusCode::internal, "Fast DDS refused a publisher or subscriber");
  }

  EndpointSpec spec =
      endpoint_spec<rmw_dds_common::ParticipantEntitiesInfo>(kGraphTopic, qos::latched());
  spec.user_data += kOwnMark;
  spec.in_graph = false;
  // Ours: it must not hold us alive.
  auto writer = make_raw_writer({std::shared_ptr<void>(), this}, std::move(spec));
  if (!writer.ok()) return writer.status();
  {
    const std::lock_guard<std::mutex> lock(graph_mutex_);
    graph_writer_ = std::move(writer).value();
  }
  publish_graph();
  return {};
}

ParticipantImpl::~ParticipantImpl() {
  std::unique_ptr<RawWriter> graph_writer;
  {
    const std::lock_guard<std::mutex> lock(graph_mutex_);
    graph_writer.swap(graph_writer_);
  }
  graph_writer.reset();
  leases_->close();
  if (participant_ != nullptr) {
    participant_->set_listener(nullptr);
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  if (number_ >= 0) release_number(number_);
}

Status ParticipantImpl::open(const EndpointSpec& spec, bool is_reader,
                             const std::function<Guid(dds::Topic*)>& make) {
  const std::lock_guard<std::mutex> lock(endpoint_mutex_);
  std::string error = "Fast DDS refused it";
  dds::Topic* topic = acquire_topic(spec, &error);
  const Guid guid = topic == nullptr ? Guid{} : make(topic);
  if (guid == Guid{}) {
    const bool forbidden = topic != nullptr && enclave_.secure();
    if (forbidden) {
      error = concat("the permissions of enclave ", enclave_.name, " do not allow it in domain ",
                     discovery_.domain_id);
    }
    if (topic != nullptr) release_topic(spec.dds_topic);
    return Status(forbidden ? StatusCode::unsupported : StatusCode::internal,
                  concat("cannot ", is_reader ? "subscribe to " : "publish on ", spec.dds_topic,
                         ": ", error));
  }
  if (!spec.in_graph) return {};
  {
    const std::lock_guard<std::mutex> graph_lock(graph_mutex_);
    (is_reader ? readers_ : writers_).insert(guid);
  }
  publish_graph();
  if (is_reader && spec.dds_topic.rfind(kRequestPrefix, 0) == 0) serve(spec.dds_topic);
  return {};
}

/// From now on we offer the service of this request topic.
void ParticipantImpl::serve(const std::string& dds_topic) {
  std::vector<Peer> there;
  {
    const std::lock_guard<std::mutex> lock(discovery_mutex_);
    our_services_.insert(dds_topic);
    ours_ = participant_of(to_guid(participant_->guid()));
    for (const auto& [guid, peer] : peers_) {
      if (peer.topic == dds_topic) there.push_back(peer);
    }
  }
  for (const Peer& peer : there) check_servers(peer);
}

void ParticipantImpl::check_servers(const Peer& peer) {
  if (!peer.is_reader || peer.change == Peer::Change::went) return;
  const Guid participant = participant_of(peer.guid);
  {
    const std::lock_guard<std::mutex> lock(discovery_mutex_);
    if (participant == ours_ || our_services_.count(peer.topic) == 0) return;
    if (rivals_.size() >= kMaxPeers) return;
    if (!rivals_.insert(participant).second) return;  // said already
  }
  log(LogLevel::warning,
      concat("another process offers ", peer.topic,
             ", as this one does: clients get the answer of ",
             "either; give one of them another namespace (--namespace) or domain"));
}

void ParticipantImpl::close(const EndpointSpec& spec, const Guid& guid,
                            const std::function<void()>& end) {
  if (spec.in_graph) {
    {
      const std::lock_guard<std::mutex> graph_lock(graph_mutex_);
      readers_.erase(guid);
      writers_.erase(guid);
    }
    publish_graph();
  }
  const std::lock_guard<std::mutex> lock(endpoint_mutex_);
  end();
  release_topic(spec.dds_topic);
}

dds::Topic* ParticipantImpl::acquire_topic(const EndpointSpec& spec, std::string* error) {
  dds::TypeSupport& type = types_[spec.dds_type];
  if (type.empty()) {
    type = dds::TypeSupport(new RawType(spec.dds_type));
    type.register_type(participant_);
  }

  TopicEntry& entry = topics_[spec.dds_topic];
  if (entry.topic == nullptr) {
    entry.topic = participant_->create_topic(spec.dds_topic, spec.dds_type, dds::TOPIC_QOS_DEFAULT);
    entry.dds_type = spec.dds_type;
  }
  if (entry.topic == nullptr || entry.dds_type != spec.dds_type) {
    *error = entry.topic == nullptr ? "Fast DDS refused the topic"
                                    : "this process uses it with type " + entry.dds_type;
    if (entry.topic == nullptr) topics_.erase(spec.dds_topic);
    return nullptr;
  }
  ++entry.users;
  std::vector<Peer> there;
  {
    const std::lock_guard<std::mutex> lock(discovery_mutex_);
    if (!our_types_.emplace(spec.dds_topic, spec.dds_type).second) return entry.topic;
    for (const auto& [guid, peer] : peers_) {
      if (peer.topic == spec.dds_topic) there.push_back(peer);
    }
  }
  for (const Peer& peer : there) check_type(peer, spec.dds_type);
  return entry.topic;
}

void ParticipantImpl::release_topic(const std::string& dds_topic) {
  const auto entry = topics_.find(dds_topic);
  if (entry == topics_.end() || --entry->second.users > 0) return;
  participant_->delete_topic(entry->second.topic);
  topics_.erase(entry);
  const std::lock_guard<std::mutex> lock(discovery_mutex_);
  our_types_.erase(dds_topic);
  our_services_.erase(dds_topic);
}

GraphLayout ParticipantImpl::graph_layout() const {
  if (options_.graph_layout != GraphLayout::automatic) return options_.graph_layout;
  const std::lock_guard<std::mutex> lock(discovery_mutex_);
  return guess_.layout();
}

void ParticipantImpl::publish_graph() {
  const GraphLayout layout = graph_layout();
  const std::lock_guard<std::mutex> lock(graph_mutex_);
  if (graph_writer_ == nullptr) return;
  const std::vector<std::uint8_t> bytes =
      encode_graph(layout, to_guid(participant_->guid()), options_.node, readers_, writers_);
  const Status status = graph_writer_->write(bytes_ref(bytes), nullptr, nullptr);
  if (!status.ok()) log(LogLevel::warning, "ros_discovery_info: " + status.message);
}

void ParticipantImpl::check_type(const Peer& peer, const std::string& ours) const {
  if (ours.empty()) return;
  if (peer.only_xcdr2) {
    log_peer(
        LogLevel::warning, peer.guid,
        concat("topic ", peer.topic, ": a peer's ",
               peer.is_reader ? "subscriber takes" : "publisher offers",
               " XCDR2 alone, ours is XCDR1, as in ROS 2; they will not talk: add XCDR1 to the "
               "peer's data representation, or make its types @final and leave it out"));
  }
  if (ours == peer.type) return;
  log_peer(LogLevel::warning, peer.guid,
           concat("topic ", peer.topic, ": a peer's ", peer.is_reader ? "subscriber" : "publisher",
                  " has type ", peer.type, ", ours is ", ours,
                  "; they will not talk: remap one of them or correct its type"));
}

void ParticipantImpl::on_peer(const Peer& peer) {
  const GraphLayout before = graph_layout();
  std::string ours;
  {
    const std::lock_guard<std::mutex> lock(discovery_mutex_);
    const bool went = peer.change == Peer::Change::went;
    const bool of_graph = peer.topic == kGraphTopic;
    if (of_graph && !went) guess_.discovered(peer.guid, peer.user_data);
    if (of_graph && went) guess_.removed(peer.guid);
    if (went) peers_.erase(peer.guid);
    if (peer.change == Peer::Change::came) {
      if (peers_.size() < kMaxPeers) peers_.emplace(peer.guid, peer);
      const auto entry = our_types_.find(peer.topic);
      if (entry != our_types_.end()) ours = entry->second;
    }
  }
  check_type(peer, ours);
  if (peer.change == Peer::Change::came) check_servers(peer);
  if (graph_layout() == before) return;
  // Not from here: the caller holds the locks of the discovery protocol.
  tasks_.run_at(TaskThread::Clock::now(), [this] { publish_graph(); });
}

std::optional<EndpointSpec> ParticipantImpl::find_published(const std::string& dds_topic) const {
  const std::lock_guard<std::mutex> lock(discovery_mutex_);
  std::optional<EndpointSpec> found;
  for (const auto& [guid, peer] : peers_) {
    if (peer.is_reader || peer.topic != dds_topic) continue;
    if (!found) found = EndpointSpec{peer.topic, peer.type, peer.user_data, peer.qos};
    Qos& all = found->qos;
    if (peer.qos.reliability == Reliability::best_effort) all.reliability = peer.qos.reliability;
    if (peer.qos.durability == Durability::volatile_) all.durability = peer.qos.durability;
  }
  return found;
}

}  // namespace detail

namespace {

using eprosima::fastdds::dds::Log;
using eprosima::fastdds::dds::LogConsumer;

/// What open() says in fewer words.
bool is_said_by_open(std::string_view message) {
  for (const char* words : {" not found in allow rule", "Not found topic access rule",
                            "Error checking creation of local ", "Problem creating associated "}) {
    if (message.find(words) != std::string_view::npos) return true;
  }
  return false;
}

class Bridge : public LogConsumer {
 public:
  explicit Bridge(LogHook hook) : hook_(std::move(hook)) {}

  void Consume(const Log::Entry& entry) override {
    const bool error = entry.kind == Log::Kind::Error && !is_said_by_open(entry.message);
    // What its security says has no function.
    const auto known = [](const char* name) { return name == nullptr ? "" : name; };
    const SourceLocation location{known(entry.context.filename), known(entry.context.function),
                                  entry.context.line};
    log(hook_, error ? LogLevel::warning : LogLevel::debug, "Fast DDS: " + entry.message, location);
  }

 private:
  LogHook hook_;
};

/// Takes Fast DDS's own messages, which it would print, to a hook: its errors as warnings, its
/// warnings and what we say of them ourselves as debug. Fast DDS has one log a process; the hook of
/// the last participant gets it.
void bridge_log(const LogHook& hook) {
  Log::ClearConsumers();
  if (!hook) return;
  Log::SetVerbosity(Log::Kind::Warning);
  Log::RegisterConsumer(std::make_unique<Bridge>(hook));
}

}  // namespace

Participant::Participant(std::shared_ptr<detail::ParticipantImpl> impl) : impl_(std::move(impl)) {}

Result<Participant> Participant::create(ParticipantOptions options) {
  if (Status s = validate_full_name(options.node.full()); !s.ok()) return s;
  if (options.node.name.find('/') != std::string::npos) {
    return invalid_argument("node name '" + options.node.name + "' must not have a slash");
  }
  const Result<Discovery> discovery =
      options.discovery ? *options.discovery : discovery_from_environment();
  if (!discovery.ok()) return discovery.status();
  bridge_log(options.log);
  auto enclave = detail::find_enclave(options.security, options.log);
  if (!enclave.ok()) return enclave.status();
  auto impl = std::make_shared<detail::ParticipantImpl>(std::move(options), *discovery,
                                                        std::move(enclave).value());
  if (Status s = impl->start(); !s.ok()) return s;
  return Participant(std::move(impl));
}

const NodeName& Participant::node() const { return impl_->options().node; }

int Participant::domain_id() const { return impl_->domain_id(); }

const std::string& Participant::enclave_folder() const { return impl_->enclave().folder; }

Result<std::string> Participant::resolve(std::string_view name) const {
  return resolve_name(name, node(), impl_->options().remaps);
}

GraphLayout Participant::graph_layout() const { return impl_->graph_layout(); }

Guid guid_of(const Participant& participant) { return participant.impl()->guid(); }

const LogHook& detail::participant_log(const Participant& participant) {
  return participant.impl()->options().log;
}

std::optional<detail::EndpointSpec> detail::find_published(const Participant& participant,
                                                           const std::string& dds_topic) {
  return participant.impl()->find_published(dds_topic);
}

TaskThread& detail::participant_tasks(const Participant& participant) {
  return participant.impl()->tasks();
}

}  // namespace bpa::wire

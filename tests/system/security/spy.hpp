// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>

namespace bpa::test {

/// A plain Fast DDS participant of this machine that notes the topics that it sees.
class Spy : private eprosima::fastdds::dds::DomainParticipantListener {
 public:
  explicit Spy(int domain) {
    namespace rtps = eprosima::fastdds::rtps;
    auto qos = eprosima::fastdds::dds::PARTICIPANT_QOS_DEFAULT;
    auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
    udp->maxInitialPeersRange = 32;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    auto& builtin = qos.wire_protocol().builtin;
    builtin.metatrafficUnicastLocatorList.push_back(rtps::Locator_t());
    rtps::Locator_t this_machine;
    rtps::IPLocator::setIPv4(this_machine, "127.0.0.1");
    builtin.initialPeersList.push_back(this_machine);
    participant_ = factory().create_participant(static_cast<std::uint32_t>(domain), qos, this,
                                                eprosima::fastdds::dds::StatusMask::none());
  }
  ~Spy() override {
    if (participant_ == nullptr) return;
    participant_->set_listener(nullptr);
    factory().delete_participant(participant_);
  }

  std::set<std::string> topics() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return topics_;
  }

 private:
  static eprosima::fastdds::dds::DomainParticipantFactory& factory() {
    return *eprosima::fastdds::dds::DomainParticipantFactory::get_instance();
  }
  void on_data_writer_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastdds::rtps::WriterDiscoveryStatus,
                                const eprosima::fastdds::dds::PublicationBuiltinTopicData& data,
                                bool&) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    topics_.insert(data.topic_name.to_string());
  }
  void on_data_reader_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastdds::rtps::ReaderDiscoveryStatus,
                                const eprosima::fastdds::dds::SubscriptionBuiltinTopicData& data,
                                bool&) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    topics_.insert(data.topic_name.to_string());
  }

  mutable std::mutex mutex_;
  std::set<std::string> topics_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
};

}  // namespace bpa::test

// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Machines that are folders.
#include "core/doctor/machine_check.hpp"

#include <gtest/gtest.h>

#include "tests/core/doctor/findings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::doctor {
namespace {

using test::spill;
using test::Whats;
using test::whats;

class CheckMachine : public testing::Test {
 protected:
  void SetUp() override {
    spill(root_ / "proc/sys/net/core/rmem_max", "4194304\n");
    spill(root_ / "proc/sys/net/ipv4/ip_local_port_range", "32768\t60999\n");
    spill(root_ / "sys/class/net/lo/flags", "0x9\n");       // up
    spill(root_ / "sys/class/net/eth0/flags", "0x1003\n");  // up, multicast
    needs_.root = root_.path();
    needs_.multicast = true;
    needs_.image_bytes = 921600;
  }
  Whats found() const { return whats(check_machine(needs_)); }

  test::TemporaryFolder root_;
  MachineNeeds needs_;
};

TEST_F(CheckMachine, SaysNothingOfAGoodOne) { EXPECT_EQ(found(), Whats{}); }

TEST_F(CheckMachine, SaysNothingOfWhatItCannotSee) {
  needs_.root = root_ / "nothing";
  EXPECT_EQ(found(), Whats{});
}

TEST_F(CheckMachine, SmallSocketBuffers) {
  spill(root_ / "proc/sys/net/core/rmem_max", "212992\n");
  EXPECT_EQ(found(), Whats{"socket buffers are small for images"});
}

// As ROS 2's documentation has it for Linux: 0 to 101 and 215 to 232.
TEST_F(CheckMachine, DomainsWhosePortsOthersTake) {
  for (const auto& [domain, expected] :
       {std::pair(100, Whats{}), std::pair(101, Whats{}),
        std::pair(102, Whats{"other programs may take the DDS domain's ports"}),
        std::pair(214, Whats{"other programs may take the DDS domain's ports"}),
        std::pair(215, Whats{}), std::pair(232, Whats{}),
        std::pair(233, Whats{"the DDS domain is out of range"}),
        std::pair(-1, Whats{"the DDS domain is out of range"})}) {
    needs_.domain = domain;
    EXPECT_EQ(found(), expected) << domain;
  }
}

TEST_F(CheckMachine, NetworkInterfaces) {
  spill(root_ / "sys/class/net/eth0/flags", "0x1002\n");  // down
  EXPECT_EQ(found(), Whats{"no network interface has multicast"});
  needs_.multicast = false;
  EXPECT_EQ(found(), Whats{});
  spill(root_ / "sys/class/net/lo/flags", "0x8\n");
  EXPECT_EQ(found(), Whats{"the loopback interface is down"});
}

}  // namespace
}  // namespace bpa::doctor

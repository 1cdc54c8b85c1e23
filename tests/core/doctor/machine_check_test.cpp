// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Machines that are folders.
#include "core/doctor/machine_check.hpp"

#include <gtest/gtest.h>

#include "tests/core/doctor/findings.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa {
namespace {

using test::spill;
using test::Whats;
using test::whats;

class CheckMachine : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(root_ / "dev/shm");
    spill(root_ / "proc/sys/net/core/rmem_max", "4194304\n");
    spill(root_ / "proc/sys/net/ipv4/ip_local_port_range", "32768\t60999\n");
    spill(root_ / "sys/class/net/lo/flags", "0x9\n");       // up
    spill(root_ / "sys/class/net/eth0/flags", "0x1003\n");  // up, multicast
    needs_.root = root_.path();
    needs_.multicast = true;
    needs_.shm_bytes = 1;
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

TEST_F(CheckMachine, LittleSharedMemory) {
  needs_.shm_bytes = std::uint64_t{1} << 60U;
  EXPECT_EQ(found(), Whats{"/dev/shm is too small to share frames"});
}

TEST_F(CheckMachine, FilesOfProcessesThatHaveEnded) {
  needs_.leftover_bytes = 1U << 20U;
  const std::string bytes(600U << 10U, 'x');
  spill(root_ / "dev/shm/fast_datasharing_01_0.0", bytes);
  spill(root_ / "dev/shm/somebody_elses", std::string(4U << 20U, 'x'));
  EXPECT_EQ(found(), Whats{}) << "little is no matter";
  spill(root_ / "dev/shm/fast_datasharing_02_0.0", bytes);
  EXPECT_EQ(found(), Whats{"killed DDS programs have left files in /dev/shm"});
  spill(root_ / "proc/17/maps",
        "7f00-7f01 rw-s 00000000 00:19 5   /dev/shm/fast_datasharing_02_0.0\n");
  EXPECT_EQ(found(), Whats{}) << "one is in use";
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
}  // namespace bpa

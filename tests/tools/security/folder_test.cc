// The folder of keys: whole or not there, never written over, and what `check` finds in it.
#include "tools/security/folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"
#include "tools/security/documents.h"

namespace sinew::security {
namespace {

namespace fs = std::filesystem;
using sinew::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class FolderTest : public ::testing::Test {
 protected:
  FolderTest() {
    Create(folder_, {"rig", 7},
           {{"surrogate", {"provider"}, "robot"}, {"observer", {"observer"}, "desk"}});
  }
  std::vector<std::string> Faults() const { return Check(folder_).faults; }
  void Replace(const std::string& file, const std::string& text) const {
    config::WriteFileAtomically(folder_ / file, text);
    fs::permissions(folder_ / file, fs::perms::owner_read | fs::perms::owner_write);
  }
  std::string Read(const std::string& file) const { return config::ReadFile(folder_ / file); }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path() / "rig.security";
};

std::string ErrorOf(const std::function<void()>& act) {
  try {
    act();
    return "none";
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST_F(FolderTest, ANewOneHasNoFaultAndIsItsOwnersAlone) {
  const Report report = Check(folder_);
  EXPECT_THAT(report.faults, IsEmpty());
  EXPECT_THAT(report.notes, IsEmpty());
  EXPECT_EQ(report.certificates, 2);
  constexpr fs::perms kOthers = fs::perms::group_all | fs::perms::others_all;
  EXPECT_EQ(fs::status(folder_).permissions() & kOthers, fs::perms::none);
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    EXPECT_EQ(entry.status().permissions() & kOthers, fs::perms::none) << entry.path();
  }
}

TEST_F(FolderTest, NothingIsWrittenOverAndNothingIsLeftHalfMade) {
  const std::string key = Read("observer/private.key");
  EXPECT_THAT(ErrorOf([&] {
                Create(folder_, {"rig", 7}, {});
              }),
              HasSubstr("rig.security: is there already, expected a new name"));
  EXPECT_THAT(ErrorOf([&] {
                Add(folder_, {"observer", {"operator"}, "desk"});
              }),
              HasSubstr("observer: is there already"));
  EXPECT_EQ(Read("observer/private.key"), key);
  EXPECT_THAT(ErrorOf([&] { Add(folder_, {"alice", {"king"}, "desk"}); }), HasSubstr("no role"));
  EXPECT_THAT(ErrorOf([&] {
                Add(folder_, {"../alice", {"operator"}, "desk"});
              }),
              HasSubstr("name '../alice': expected letters"));
  EXPECT_THAT(ErrorOf([&] {
                Add(folder_, {"alice", {"operator"}, "a b"});
              }),
              HasSubstr("host 'a b': expected letters"));
  EXPECT_THAT(ErrorOf([&] {
                Create(temporary_.path() / "other", {"rig", 7},
                       {{"twin", {"observer"}, "desk"}, {"twin", {"observer"}, "desk"}});
              }),
              HasSubstr("'twin': given twice"));
  std::size_t entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(temporary_.path())) ++entries;
  EXPECT_EQ(entries, 1u);
}

TEST_F(FolderTest, AFurtherCertificateIsOfTheSameAuthorities) {
  Add(folder_, {"alice", {"operator"}, "desk"});
  EXPECT_THAT(Faults(), IsEmpty());
  fs::remove_all(folder_ / "authority");  // kept elsewhere
  EXPECT_THAT(Faults(), IsEmpty());
  EXPECT_THAT(Check(folder_ / "alice").faults, IsEmpty());
  EXPECT_THAT(ErrorOf([&] {
                Add(folder_, {"bob", {"operator"}, "desk"});
              }),
              HasSubstr("authority"));
}

TEST_F(FolderTest, AKeyThatOthersMayReadIsAFault) {
  fs::permissions(folder_ / "observer/private.key", fs::perms(0640));
  fs::permissions(folder_ / "authority/permissions_ca.key", fs::perms(0604));
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("authority/permissions_ca.key: others may read"),
                                    HasSubstr("observer/private.key: others may read")));
}

TEST_F(FolderTest, PermissionsOfSomebodyElseAreAFault) {
  Replace("observer/permissions.p7s", Read("surrogate/permissions.p7s"));
  EXPECT_THAT(Faults(),
              ElementsAre(AllOf(HasSubstr("observer/permissions.p7s: differs, expected what this"),
                                HasSubstr("(observer)"))));
}

TEST_F(FolderTest, ARoleThatWasNotGrantedIsAFault) {
  std::string member = Read("observer/member.yaml");
  member.replace(member.find("roles: [observer]"), 17, "roles: [operator]");
  Replace("observer/member.yaml", member);
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("observer/permissions.p7s: differs")));
}

TEST_F(FolderTest, AChangedDocumentIsAFault) {
  std::string text = Read("observer/governance.p7s");
  text.replace(text.find("ENCRYPT"), 7, "NONE   ");
  Replace("observer/governance.p7s", text);
  Replace("surrogate/governance.p7s", "nothing");
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("observer/governance.p7s: has no signature of"),
                                    HasSubstr("surrogate/governance.p7s: no signed document")));
}

TEST_F(FolderTest, CertificatesOfAnotherAuthorityAndKeysOfAnotherCertificateAreFaults) {
  Replace("observer/private.key", Read("surrogate/private.key"));
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("observer/private.key: is not the key of")));
  const fs::path other = temporary_.path() / "other";
  Create(other, {"rig", 7}, {{"observer", {"observer"}, "desk"}});
  fs::remove_all(folder_ / "observer");
  fs::copy(other / "observer", folder_ / "observer");
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("observer/identity_ca.pem: is another one than"),
                                    HasSubstr("observer/permissions_ca.pem: is another one than")));
  Replace("observer/identity_ca.pem", Read("authority/identity_ca.pem"));
  EXPECT_THAT(Faults()[0], HasSubstr("observer/certificate.pem: "));
}

TEST_F(FolderTest, OneAuthorityForBothIsAFault) {
  Replace("observer/permissions_ca.pem", Read("observer/identity_ca.pem"));
  EXPECT_THAT(Faults(), ::testing::Contains(HasSubstr("whoever has a certificate can sign")));
}

TEST_F(FolderTest, FilesThatAreMissingOrProfilesWithoutSecurityAreFaults) {
  fs::remove(folder_ / "observer/certificate.pem");
  fs::remove(folder_ / "surrogate/qos.xml");
  EXPECT_THAT(Faults(),
              ElementsAre(HasSubstr("observer/certificate.pem"), HasSubstr("surrogate/qos.xml")));
  Replace("surrogate/qos.xml", "<dds/>");
  EXPECT_THAT(Check(folder_ / "surrogate").faults, SizeIs(SecurityProperties().size()));
}

TEST_F(FolderTest, ACertificateThatSoonEndsIsANote) {
  Add(folder_, {"guest", {"observer"}, "desk"}, {.certificate = 10});
  EXPECT_THAT(Check(folder_).notes, ElementsAre(HasSubstr("guest/certificate.pem: ends on 20")));
  EXPECT_THAT(Faults(), IsEmpty());
}

TEST_F(FolderTest, WhatIsNoFolderOfKeysIsRefused) {
  EXPECT_THAT(ErrorOf([&] { (void)Check(temporary_.path() / "none"); }), HasSubstr("no folder"));
  EXPECT_THAT(Check(temporary_.path()).faults, ::testing::Contains(HasSubstr("security.yaml")));
}

}  // namespace
}  // namespace sinew::security

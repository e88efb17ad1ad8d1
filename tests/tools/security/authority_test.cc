// Keys, certificates and signatures; that OpenSSL's own program reads them the same way.
#include "tools/security/authority.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::security {
namespace {

using namespace std::chrono_literals;
using sinew::testing::TemporaryFolder;
using std::chrono::days;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

Seconds Now() {
  return std::chrono::time_point_cast<Seconds::duration>(std::chrono::system_clock::now());
}
Validity AYear() { return {Now() - days(1), Now() + days(365)}; }

class AuthorityTest : public ::testing::Test {
 protected:
  const Credential identities_ = MakeAuthority(Authority::kForIdentities, "rig", AYear());
  const Credential permissions_ = MakeAuthority(Authority::kForPermissions, "rig", AYear());
  const Credential own_ = Issue(identities_, {"esn", "robot", "rig"}, AYear());
};

TEST_F(AuthorityTest, ACertificateIsOfItsAuthorityAloneAndHasItsSubject) {
  EXPECT_EQ(FaultOfChain(own_.certificate, identities_.certificate), "");
  const Credential other = MakeAuthority(Authority::kForIdentities, "rig", AYear());
  EXPECT_NE(FaultOfChain(own_.certificate, other.certificate), "");
  EXPECT_NE(FaultOfChain(own_.certificate, permissions_.certificate), "");
  EXPECT_THAT(FactsOf(own_.certificate).subject,
              MatchesRegex("serialNumber=[0-9A-F]+,CN=esn,OU=robot,O=rig"));
  EXPECT_TRUE(Matches(own_));
  EXPECT_FALSE(Matches({own_.certificate, identities_.key}));
}

TEST_F(AuthorityTest, ASubjectIsNeverUsedTwice) {
  const Credential again = Issue(identities_, {"esn", "robot", "rig"}, AYear());
  EXPECT_NE(FactsOf(again.certificate).subject, FactsOf(own_.certificate).subject);
}

TEST_F(AuthorityTest, OneThatHasEndedOrNotBegunIsAFault) {
  const Credential ended =
      Issue(identities_, {"esn", "robot", "rig"}, {Now() - days(2), Now() - days(1)});
  EXPECT_THAT(FaultOfChain(ended.certificate, identities_.certificate), HasSubstr("expired"));
  const Credential early =
      Issue(identities_, {"esn", "robot", "rig"}, {Now() + days(1), Now() + days(2)});
  EXPECT_THAT(FaultOfChain(early.certificate, identities_.certificate), HasSubstr("not yet valid"));
}

TEST_F(AuthorityTest, ASignatureIsOfItsAuthorityAndOfTheWholeDocument) {
  const std::string document = "<dds>\n<topic>a</topic>\n</dds>\n";
  const std::string signed_document = Sign(permissions_, document);
  EXPECT_EQ(Verified(signed_document, permissions_.certificate), document);
  EXPECT_EQ(Verified(signed_document, identities_.certificate), std::nullopt);
  std::string changed = signed_document;
  changed.replace(changed.find(">a<"), 3, ">b<");
  EXPECT_EQ(Verified(changed, permissions_.certificate), std::nullopt);
  EXPECT_THROW((void)Verified(document, permissions_.certificate), UsageError);
}

TEST_F(AuthorityTest, TheHolderOfACertificateCannotSignPermissions) {
  const std::string forged = Sign(own_, "<dds/>\n");
  EXPECT_EQ(Verified(forged, permissions_.certificate), std::nullopt);
  // With one authority for both it would be accepted: the chain of the signer is what counts.
  EXPECT_EQ(Verified(forged, identities_.certificate), "<dds/>\n");
}

TEST_F(AuthorityTest, OpensslReadsThemTheSameWay) {
  const TemporaryFolder folder;
  const std::string ca = folder.Write("ca.pem", identities_.certificate);
  const std::string signer = folder.Write("signer.pem", permissions_.certificate);
  const std::string certificate = folder.Write("own.pem", own_.certificate);
  const std::string document = folder.Write("signed", Sign(permissions_, "<dds/>\n"));
  EXPECT_EQ(launch::Run({"openssl", "verify", "-CAfile", ca, certificate}, 30s).exit_code, 0);
  EXPECT_NE(launch::Run({"openssl", "verify", "-CAfile", signer, certificate}, 30s).exit_code, 0);
  const auto verified = launch::Run(
      {"openssl", "smime", "-verify", "-text", "-in", document, "-CAfile", signer}, 30s);
  EXPECT_EQ(verified.exit_code, 0) << verified.error;
  EXPECT_THAT(verified.output, HasSubstr("<dds/>"));
}

TEST_F(AuthorityTest, WhatIsNoCertificateOrKeyIsRefused) {
  EXPECT_THROW((void)FactsOf(""), UsageError);
  EXPECT_THROW((void)FactsOf(own_.key), UsageError);
  EXPECT_THROW((void)Matches({own_.certificate, own_.certificate}), UsageError);
}

}  // namespace
}  // namespace sinew::security

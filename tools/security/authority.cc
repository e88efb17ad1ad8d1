#include "tools/security/authority.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>
#include <stdexcept>

#include "components/base/config/config.h"

namespace sinew::security {

namespace {

template <auto free_it>
struct Free {
  template <class Object>
  void operator()(Object* object) const {
    free_it(object);
  }
};
template <class Object, auto free_it>
using Owned = std::unique_ptr<Object, Free<free_it>>;

void FreeText(char* text) { OPENSSL_free(text); }

using Bio = Owned<BIO, &BIO_free_all>;
using Key = Owned<EVP_PKEY, &EVP_PKEY_free>;
using Certificate = Owned<X509, &X509_free>;
using Message = Owned<PKCS7, &PKCS7_free>;
using Store = Owned<X509_STORE, &X509_STORE_free>;
using StoreContext = Owned<X509_STORE_CTX, &X509_STORE_CTX_free>;

constexpr int kSignature = PKCS7_TEXT | PKCS7_DETACHED;

[[noreturn]] void Fail(const std::string& what) {
  const char* reason = ERR_reason_error_string(ERR_get_error());
  ERR_clear_error();
  throw std::runtime_error(what + ": " + (reason == nullptr ? "OpenSSL gives no reason" : reason));
}

template <class Pointer>
Pointer Made(Pointer made, const char* what) {
  if (!made) Fail(what);
  return made;
}

void Demand(int result, const char* what) {
  if (result <= 0) Fail(what);
}

Bio Reading(const std::string& text) {
  return Made(Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))), "memory");
}

Bio Writing() { return Made(Bio(BIO_new(BIO_s_mem())), "memory"); }

std::string TextIn(const Bio& bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return {data, static_cast<std::size_t>(std::max(size, 0L))};
}

Certificate CertificateOf(const std::string& text) {
  const Bio bio = Reading(text);
  Certificate out(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  if (!out) throw UsageError("no certificate, expected -----BEGIN CERTIFICATE-----");
  return out;
}

Key KeyOf(const std::string& text) {
  const Bio bio = Reading(text);
  // No passphrase is asked for on a terminal.
  const auto none = [](char*, int, int, void*) { return 0; };
  Key out(PEM_read_bio_PrivateKey(bio.get(), nullptr, none, nullptr));
  ERR_clear_error();
  if (!out) throw UsageError("no private key, expected -----BEGIN PRIVATE KEY-----");
  return out;
}

Store StoreOf(const std::string& authority) {
  Store store = Made(Store(X509_STORE_new()), "a store of certificates");
  Demand(X509_STORE_add_cert(store.get(), CertificateOf(authority).get()), "an authority");
  return store;
}

void AddName(X509_NAME* name, const char* field, const std::string& value) {
  Demand(X509_NAME_add_entry_by_txt(name, field, MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(value.data()),
                                    static_cast<int>(value.size()), -1, 0),
         "a name in a certificate");
}

// 127 random bits: no two certificates have one number.
Owned<BIGNUM, &BN_free> NewNumber() {
  Owned<BIGNUM, &BN_free> number = Made(Owned<BIGNUM, &BN_free>(BN_new()), "a number");
  Demand(BN_rand(number.get(), 127, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY), "a random number");
  return number;
}

void NameSubject(X509_NAME* name, const Subject& subject) {
  AddName(name, "O", subject.deployment);
  AddName(name, "OU", subject.host);
  AddName(name, "CN", subject.name);
  const Owned<char, &FreeText> number =
      Made(Owned<char, &FreeText>(BN_bn2hex(NewNumber().get())), "a number");
  AddName(name, "serialNumber", number.get());
}

// The first bit of what stands in GUIDs.
bool HasLargeHash(const X509_NAME* name) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  Demand(X509_NAME_digest(name, EVP_sha256(), hash.data(), nullptr), "the hash of a name");
  return hash[0] >= 0x80;
}

void AddExtension(X509* certificate, int id, const char* value) {
  const Owned<X509_EXTENSION, &X509_EXTENSION_free> extension = Made(
      Owned<X509_EXTENSION, &X509_EXTENSION_free>(X509V3_EXT_conf_nid(nullptr, nullptr, id, value)),
      "an extension of a certificate");
  Demand(X509_add_ext(certificate, extension.get(), -1), "an extension of a certificate");
}

void SetTime(ASN1_TIME* to, Seconds time) {
  if (ASN1_TIME_set(to, std::chrono::system_clock::to_time_t(time)) == nullptr) Fail("a time");
}

Seconds TimeOf(const ASN1_TIME* time) {
  std::tm fields{};
  Demand(ASN1_TIME_to_tm(time, &fields), "a time in a certificate");
  return std::chrono::time_point_cast<Seconds::duration>(
      std::chrono::system_clock::from_time_t(::timegm(&fields)));
}

struct Draft {
  Certificate certificate;
  Key key;
};

Draft NewDraft(const Validity& validity) {
  Draft out{Made(Certificate(X509_new()), "a certificate"),
            Made(Key(EVP_EC_gen("P-256")), "a private key")};
  X509* certificate = out.certificate.get();
  Demand(X509_set_version(certificate, X509_VERSION_3), "a certificate");
  const auto number = NewNumber();
  if (BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) == nullptr) {
    Fail("the number of a certificate");
  }
  SetTime(X509_getm_notBefore(certificate), validity.not_before);
  SetTime(X509_getm_notAfter(certificate), validity.not_after);
  Demand(X509_set_pubkey(certificate, out.key.get()), "the key of a certificate");
  return out;
}

Credential Finished(const Draft& draft, EVP_PKEY* authority) {
  Demand(X509_sign(draft.certificate.get(), authority, EVP_sha256()), "signing a certificate");
  const Bio certificate = Writing(), key = Writing();
  Demand(PEM_write_bio_X509(certificate.get(), draft.certificate.get()), "a certificate");
  Demand(
      PEM_write_bio_PrivateKey(key.get(), draft.key.get(), nullptr, nullptr, 0, nullptr, nullptr),
      "a private key");
  return {TextIn(certificate), TextIn(key)};
}

}  // namespace

Credential MakeAuthority(Authority authority, const std::string& deployment,
                         const Validity& validity) {
  const Draft draft = NewDraft(validity);
  X509* certificate = draft.certificate.get();
  X509_NAME* name = X509_get_subject_name(certificate);
  const bool identities = authority == Authority::kForIdentities;
  AddName(name, "O", deployment);
  AddName(name, "CN", identities ? "identities" : "permissions");
  Demand(X509_set_issuer_name(certificate, name), "an authority");
  AddExtension(certificate, NID_basic_constraints,
               identities ? "critical,CA:TRUE,pathlen:0" : "critical,CA:FALSE");
  AddExtension(certificate, NID_key_usage,
               identities ? "critical,keyCertSign,cRLSign" : "critical,digitalSignature");
  return Finished(draft, draft.key.get());
}

Credential Issue(const Credential& authority, const Subject& subject, const Validity& validity) {
  const Draft draft = NewDraft(validity);
  X509* certificate = draft.certificate.get();
  using Name = Owned<X509_NAME, &X509_NAME_free>;
  Name name;
  do {
    name = Made(Name(X509_NAME_new()), "a name");
    NameSubject(name.get(), subject);
  } while (HasLargeHash(name.get()) == subject.other_library);
  Demand(X509_set_subject_name(certificate, name.get()), "the name of a certificate");
  const Certificate issuer = CertificateOf(authority.certificate);
  Demand(X509_set_issuer_name(certificate, X509_get_subject_name(issuer.get())), "a certificate");
  AddExtension(certificate, NID_basic_constraints, "critical,CA:FALSE");
  AddExtension(certificate, NID_key_usage, "critical,digitalSignature");
  return Finished(draft, KeyOf(authority.key).get());
}

CertificateFacts FactsOf(const std::string& certificate) {
  const Certificate parsed = CertificateOf(certificate);
  const Bio name = Writing();
  // As Fast DDS compares it with the grant's.
  Demand(X509_NAME_print_ex(name.get(), X509_get_subject_name(parsed.get()), 0,
                            XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB),
         "the name of a certificate");
  return {TextIn(name),
          {TimeOf(X509_get0_notBefore(parsed.get())), TimeOf(X509_get0_notAfter(parsed.get()))}};
}

bool Matches(const Credential& credential) {
  const bool matches = X509_check_private_key(CertificateOf(credential.certificate).get(),
                                              KeyOf(credential.key).get()) == 1;
  ERR_clear_error();
  return matches;
}

std::string FaultOfChain(const std::string& certificate, const std::string& authority) {
  const Certificate parsed = CertificateOf(certificate);
  const Store store = StoreOf(authority);
  const StoreContext context = Made(StoreContext(X509_STORE_CTX_new()), "a chain");
  Demand(X509_STORE_CTX_init(context.get(), store.get(), parsed.get(), nullptr), "a chain");
  const bool good = X509_verify_cert(context.get()) == 1;
  ERR_clear_error();
  if (good) return {};
  return X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get()));
}

std::string Sign(const Credential& authority, const std::string& document) {
  const Bio content = Reading(document), out = Writing();
  const Message message =
      Made(Message(PKCS7_sign(CertificateOf(authority.certificate).get(),
                              KeyOf(authority.key).get(), nullptr, content.get(), kSignature)),
           "signing a document");
  Demand(BIO_reset(content.get()), "signing a document");
  Demand(SMIME_write_PKCS7(out.get(), message.get(), content.get(), kSignature),
         "signing a document");
  return TextIn(out);
}

std::optional<std::string> Verified(const std::string& signed_document,
                                    const std::string& authority) {
  const Bio in = Reading(signed_document);
  BIO* content = nullptr;
  const Message message(SMIME_read_PKCS7(in.get(), &content));
  const Bio owned(content);
  ERR_clear_error();
  if (!message) throw UsageError("no signed document, expected S/MIME");
  const Store store = StoreOf(authority);
  const Bio out = Writing();
  const bool good =
      PKCS7_verify(message.get(), nullptr, store.get(), content, out.get(), PKCS7_TEXT) == 1;
  ERR_clear_error();
  if (!good) return std::nullopt;
  std::string text = TextIn(out);
  std::erase(text, '\r');
  return text;
}

}  // namespace sinew::security

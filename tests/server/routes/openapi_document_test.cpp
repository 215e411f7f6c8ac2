// server/openapi.json in itself. Its routes and scopes are compared in http_routes_test.cpp and
// admin_test.cpp.
#include "tests/support/openapi_document.h"

#include <gtest/gtest.h>

#include <set>

namespace hermite::server {
namespace {

using Json = nlohmann::json;

// All values of "$ref" in `part`, with the place where each of them stands.
void collect_references(const Json& part, const std::string& place,
                        std::map<std::string, std::string>& references) {
  if (!part.is_structured()) return;
  for (const auto& [key, value] : part.items()) {
    if (key == "$ref" && value.is_string())
      references[place] = value;
    else
      collect_references(value, place + "/" + key, references);
  }
}

TEST(OpenApiDocument, EveryReferenceResolves) {
  const Json document = test::openapi_document();
  std::map<std::string, std::string> references;
  collect_references(document, "", references);
  EXPECT_FALSE(references.empty());
  for (const auto& [place, reference] : references) {
    ASSERT_TRUE(reference.starts_with("#/"))
        << place << " in " << test::kOpenApiFile << " refers to another file: " << reference;
    EXPECT_TRUE(document.contains(Json::json_pointer(reference.substr(1))))
        << place << " in " << test::kOpenApiFile << " refers to " << reference
        << ", which is not there";
  }
}

TEST(OpenApiDocument, EveryOperationHasAnIdOfItsOwn) {
  std::map<std::string, std::string> routes;  // by id
  for (const auto& [route, operation] : test::described_operations(test::openapi_document())) {
    const std::string id = operation.value("operationId", "");
    EXPECT_NE(id, "") << route << " in " << test::kOpenApiFile << " has no operationId";
    const auto [other, is_new] = routes.emplace(id, route);
    EXPECT_TRUE(is_new) << route << " in " << test::kOpenApiFile << " has the operationId of "
                        << other->second << ": " << id;
  }
}

// Whoever generates a client from it needs every part of a path as a parameter.
TEST(OpenApiDocument, EveryPartOfAPathIsDescribed) {
  const Json document = test::openapi_document();
  for (const auto& [route, operation] : test::described_operations(document)) {
    const std::string path = route.substr(route.find(' ') + 1);
    std::set<std::string> described, written;
    for (const Json& list : {document["paths"][path].value("parameters", Json::array()),
                             operation.value("parameters", Json::array())})
      for (Json parameter : list) {
        if (parameter.contains("$ref"))
          parameter =
              document.at(Json::json_pointer(parameter["$ref"].get<std::string>().substr(1)));
        if (parameter["in"] == "path") described.insert(parameter["name"]);
      }
    for (std::size_t at = path.find('{'); at != std::string::npos; at = path.find('{', at + 1))
      written.insert(path.substr(at + 1, path.find('}', at) - at - 1));
    EXPECT_EQ(described, written) << "parameters of " << route << " in " << test::kOpenApiFile;
  }
}

}  // namespace
}  // namespace hermite::server

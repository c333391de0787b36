#include "scene/schema.h"

#include <string>

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace pvg {
namespace {

struct ParsedSchema {
    nlohmann::json document = nlohmann::json::parse(scene_schema());
    valijson::Schema schema;
    ParsedSchema() {
        valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
        parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(document), schema);
    }
};

}  // namespace

std::optional<std::string> schema_violation(const nlohmann::json& document) {
    static const ParsedSchema parsed;
    valijson::Validator validator;
    valijson::ValidationResults results;
    if (validator.validate(parsed.schema, valijson::adapters::NlohmannJsonAdapter(document), &results))
        return std::nullopt;
    valijson::ValidationResults::Error error;
    std::string message = "does not fit the schema";
    // The first error is the innermost one: ["<root>", "[layers]", "[0]", ...].
    if (results.popError(error)) {
        std::string pointer;
        for (const std::string& step : error.context) {
            if (step.size() >= 2 && step.front() == '[')
                pointer += "/" + step.substr(1, step.size() - 2);
        }
        message = pointer + ": " + error.description;
    }
    return message;
}

}  // namespace pvg

"""Writes an SPDX 2.3 list of a release: python3 spdx.py VERSION COMMIT <LINES, each "source-package version licence" of
what is linked into the static programs and the wheel, and whose source packages Debian has."""
import datetime
import json
import subprocess
import sys

version, commit = sys.argv[1:]


def package(identifier, name, of_version, licence, **more):
    return {
        "SPDXID": f"SPDXRef-{identifier}",
        "name": name,
        "versionInfo": of_version,
        "licenseConcluded": licence,
        "licenseDeclared": licence,
        "copyrightText": "NOASSERTION",
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        **more,
    }


def inside(line):
    name, of_version, licence = line.split()
    reference = {
        "referenceCategory": "PACKAGE-MANAGER",
        "referenceType": "purl",
        "referenceLocator": f"pkg:deb/debian/{name}@{of_version}?arch=source",
    }
    return package(name, name, of_version, licence, externalRefs=[reference])


linked = [inside(line) for line in sys.stdin if line.strip()]
# The time of the commit, so that the same source gives the same file.
seconds = int(subprocess.check_output(["git", "show", "-s", "--format=%ct", commit]))
created = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
document = {
    "spdxVersion": "SPDX-2.3",
    "dataLicense": "CC0-1.0",
    "SPDXID": "SPDXRef-DOCUMENT",
    "name": f"welkin-{version}",
    "documentNamespace": f"https://welkin.invalid/spdx/{version}/{commit}",
    "creationInfo": {"created": created, "creators": ["Tool: welkin-scripts-release"]},
    "packages": [package("welkin", "welkin", version, "MIT", sourceInfo=f"git commit {commit}"), *linked],
    "relationships": [
        {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-welkin"}
    ]
    + [
        {"spdxElementId": "SPDXRef-welkin", "relationshipType": "STATIC_LINK", "relatedSpdxElement": one["SPDXID"]}
        for one in linked
    ],
}
json.dump(document, sys.stdout, indent=1)
print()

#!/usr/bin/env bash
# Signs an executable or installer for Windows (Authenticode) with osslsigncode. Without a certificate it does nothing.
#
#   tools/windows/sign.sh FILE [NAME]
#
# ENCODER_STUDIO_CERTIFICATE             file with certificate and key (PKCS #12)
# ENCODER_STUDIO_CERTIFICATE_PASSWORD    file with its password
# ENCODER_STUDIO_TIMESTAMP_URL           server for the time of the signature, so that it outlives the certificate; optional
set -euo pipefail
file=$1
name=${2:-$(basename "$file")}
if [ -z "${ENCODER_STUDIO_CERTIFICATE:-}" ]; then
    echo "$name is not signed: ENCODER_STUDIO_CERTIFICATE is not set."
    exit
fi
time=()
[ -z "${ENCODER_STUDIO_TIMESTAMP_URL:-}" ] || time=(-ts "$ENCODER_STUDIO_TIMESTAMP_URL")
signed=$(mktemp)
trap 'rm -f "$signed"' EXIT
rm "$signed"
osslsigncode sign -h sha256 -pkcs12 "$ENCODER_STUDIO_CERTIFICATE" -readpass "$ENCODER_STUDIO_CERTIFICATE_PASSWORD" \
    -n encoder-studio "${time[@]}" -in "$file" -out "$signed" >/dev/null
mv "$signed" "$file"
chmod 644 "$file"
echo "$name is signed."

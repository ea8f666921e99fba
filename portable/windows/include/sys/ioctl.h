/* Windows: empty; libfyaml includes it. */

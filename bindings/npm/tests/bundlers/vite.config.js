// The default worker format of Vite does not support code splitting.
export default { base: "./", build: { target: "es2022", outDir: "dist-vite" }, worker: { format: "es" } };

// The default worker format of Vite cannot split code.
export default { base: "./", build: { target: "es2022", outDir: "dist-vite" }, worker: { format: "es" } };

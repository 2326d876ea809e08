// The target is ES2022, because `main.js` has a top-level `await`.
export default { base: "./", build: { target: "es2022", chunkSizeWarningLimit: 2000 } };

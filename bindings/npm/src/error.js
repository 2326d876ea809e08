/** An error with a code: the name of a status of the library, or `FLOAT`, `INIT`, `DISPOSED`, `MEMORY`, `RELAY`. */
export class Lockstep2dError extends Error {
    constructor(code, message) {
        super(message);
        this.name = "Lockstep2dError";
        this.code = code;
    }
}
